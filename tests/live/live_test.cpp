// Images that are sent to a viewer, to a receiver that checks every byte.
#include "burnish/live.h"

#include <sys/wait.h>

#include <filesystem>
#include <functional>
#include <set>

#include "burnish/error.h"
#include "live/connection.h"
#include "live/packets.h"
#include "live/receiver.h"
#include "live/sender.h"
#include "optimize/small_problem.h"

namespace burnish {
namespace {

using testing::Received;
using testing::Receiver;
using testing::TakenPort;
using testing::Viewer;
using Clock = std::chrono::steady_clock;

/// A bytes literal with its zeros.
template <std::size_t n>
std::string bytes(const char (&text)[n]) {
    return {text, n - 1};
}

double seconds_of(const std::function<void()>& body) {
    const auto begin = Clock::now();
    body();
    return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// Whether the last value of an image has come.
bool has_last(const Viewer& viewer, const std::string& name, float value) {
    const auto found = viewer.images.find(name);
    return found != viewer.images.end() && found->second.values.back() == value;
}

/// What a run hears of its viewer.
struct Notes {
    std::mutex mutex;
    std::vector<std::string> texts;
    std::function<void(const std::string&)> hear() {
        return [this](const std::string& text) {
            const std::lock_guard lock(mutex);
            texts.push_back(text);
        };
    }
    std::vector<std::string> heard() {
        const std::lock_guard lock(mutex);
        return texts;
    }
};

TEST(Packets, HaveTheseBytes) {
    EXPECT_EQ(open_packet("a.exr"), bytes("\x0d\0\0\0\x07\x01"
                                          "a.exr\0\0"));
    EXPECT_EQ(close_packet("ab"), bytes("\x08\0\0\0\x02"
                                        "ab\0"));
    const Image gray{2, 3, 1, {0, 1, 2, 3, 4, 5}};
    EXPECT_EQ(create_packet("g", gray, true),
              bytes("\x16\0\0\0\x04\x01g\0\x02\0\0\0\x03\0\0\0\x01\0\0\0L\0"));
    EXPECT_EQ(update_packet("g", gray, 1, 1), bytes("\x36\0\0\0\x06\0g\0\x01\0\0\0L\0"
                                                    "\0\0\0\0\x01\0\0\0\x02\0\0\0\x01\0\0\0"
                                                    "\0\0\0\0\0\0\0\0\x01\0\0\0\0\0\0\0"
                                                    "\0\0\0\x40\0\0\x40\x40"));
    const Image color{1, 1, 3, {1, 2, -2}};
    EXPECT_EQ(create_packet("c", color, false),
              bytes("\x1a\0\0\0\x04\0c\0\x01\0\0\0\x01\0\0\0\x03\0\0\0R\0G\0B\0"));
    EXPECT_EQ(update_packet("c", color, 0, 1).substr(0, 18),
              bytes("\x5e\0\0\0\x06\0c\0\x03\0\0\0R\0G\0B\0"));
}

TEST(Addresses, AreHostAndPort) {
    const Address missing{"127.0.0.1", "14158"};
    const auto text = [&](const char* given) {
        const Address a = parse_address(given, missing);
        return a.host + " " + a.port;
    };
    EXPECT_EQ(text("studio"), "studio 14158");
    EXPECT_EQ(text(":80"), "127.0.0.1 80");
    EXPECT_EQ(text("studio:80"), "studio 80");
    EXPECT_EQ(text("[::1]:80"), "::1 80");
    EXPECT_EQ(text("[::1]"), "::1 14158");
    for (const char* wrong : {"", ":", "a:b", "a:", "a:65536", "a:-1", "a:1:2", "::1",
                              "scenes/a.xml", "a b", "[::1]9000", "[::1]x:9000", "[]:80", "[]"})
        EXPECT_THROW(parse_address(wrong, missing), InputError) << wrong;
    for (const char* wrong : {"", "a:b"}) EXPECT_THROW(Live{wrong}, InputError) << wrong;
}

TEST(LiveTest, ImagesArriveWhole) {
    Receiver receiver;
    Image wide = make_image(700, 400, 3);  // several packets
    for (std::size_t i = 0; i < wide.values.size(); ++i) wide.values[i] = static_cast<float>(i);
    const Image small = make_image(2, 2, 1, 0.5f);
    {
        Live live(receiver.address(), "run");
        for (const float value : {0.25f, 0.75f}) {
            live.show("small", make_image(2, 2, 1, value));
            live.show("wide", wide);
            EXPECT_TRUE(receiver.sees([&](const Viewer& v) {
                const auto found = v.images.find("run/small");
                return found != v.images.end() && found->second.values[3] == value &&
                       v.images.count("run/wide");
            }));
        }
        live.show("wide", small);  // of another size
        live.show("other", small);
        live.open("/a/b.exr");
        EXPECT_TRUE(receiver.sees([](const Viewer& v) { return v.images.count("run/other"); }));
        live.close("other");
        live.show("", {});  // nothing
    }
    const Viewer& viewer = receiver.stop();
    ASSERT_EQ(viewer.images.size(), 2u);
    EXPECT_EQ(viewer.closed, std::vector<std::string>{"run/other"});
    EXPECT_EQ(viewer.opened, std::vector<std::string>{"/a/b.exr"});
    const Received& gray = viewer.images.at("run/small");
    EXPECT_TRUE(gray.created == 1 && gray.updated == 2 && gray.in_front);
    const Received& changed = viewer.images.at("run/wide");
    EXPECT_EQ(changed.values, small.values);
    EXPECT_TRUE(changed.created == 2 && changed.updated >= 5 && !changed.in_front);
}

TEST(LiveTest, LivesOnWhereItsNoteThrows) {
    const TakenPort nobody;
    std::atomic<bool> told = false;
    {
        Live live(nobody.address(), "title", [&](const std::string&) {
            told = true;
            throw std::runtime_error("of the note");
        });
        live.show("image", make_image(2, 2, 3));
        while (!told) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
}

TEST(LiveTest, RefusesWhatIsNoImage) {
    Live live("127.0.0.1:1");
    for (const Image& image : {Image{1, 1, 5, {1, 2, 3, 4, 5}}, Image{2, 2, 3, {1, 2, 3}},
                               Image{4000, 4000, 3, {1, 2, 3}}})
        EXPECT_THROW(live.show("image", image), InputError) << image.channels;
}

TEST(LiveTest, ALargeImageIsShownSmaller) {
    Receiver receiver;
    Image large = make_image(4097, 2048, 1);
    large.at(4096, 2046, 0) = 7;
    {
        Live live(receiver.address());
        live.show("large", large);
        EXPECT_TRUE(receiver.sees([](const Viewer& v) { return has_last(v, "burnish/large", 7); }));
    }
    const Received& image = receiver.stop().images.at("burnish/large");
    EXPECT_EQ(image.width, 2049);
    EXPECT_EQ(image.height, 1024);
    EXPECT_EQ(image.values.back(), 7.0f);
}

TEST(LiveTest, ShowsARunWithoutChangingIt) {
    const Problem problem = test::problem_of(test::small_scene_of(16));
    const Options options{.estimator = MonteCarlo{}, .stop = {.iterations = 6}};
    const Summary alone = solve(problem, options);
    Receiver receiver;
    Summary shown;
    {
        Live live(receiver.address(), "run");
        shown = solve(problem, options, [&](const Iteration&, const Solver& solver) {
            live.update(solver);
            return Continue;
        });
        live.show(problem, shown);
        const float last = shown.result.views[0].image.values.back();
        EXPECT_TRUE(receiver.sees([&](const Viewer& v) { return has_last(v, "run/view 0", last); }))
            << "the last that is sent";
    }
    EXPECT_TRUE(shown.state == alone.state);
    Viewer& viewer = receiver.stop();
    ASSERT_EQ(viewer.images.size(), 2 + problem.unknowns.size());
    for (std::size_t i = 0; i < problem.unknowns.size(); ++i)
        EXPECT_EQ(viewer.images["run/" + problem.unknowns[i].name].values,
                  shown.textures[i].values.values);
    EXPECT_EQ(viewer.images["run/view 0 picture"].values, problem.views[0].image.values);
    EXPECT_EQ(viewer.images["run/view 0"].values, shown.result.views[0].image.values);
}

TEST(LiveTest, ImagesAreShownWithTheirExposure) {
    Problem problem = test::problem_of(test::small_scene_of(16));
    problem.views[0].exposure = ExposureFactors{2, 3, 4};
    Solver solver(problem, {.estimator = MonteCarlo{}});
    solver.step();
    Received image;
    bool is_early = false;  // on a busy machine the second call may come after the period
    for (int attempt = 0; attempt < 20 && !is_early; ++attempt) {
        Receiver receiver;
        {
            Live live(receiver.address());
            is_early = seconds_of([&] {
                           live.update(solver);
                           live.update(solver);  // too early: does nothing
                       }) < 0.2;
            const float last = solver.image().values.back() * 4;
            EXPECT_TRUE(receiver.sees(
                [&](const Viewer& v) { return has_last(v, "burnish/view 0", last); }));
        }
        image = receiver.stop().images.at("burnish/view 0");
    }
    ASSERT_TRUE(is_early);
    EXPECT_EQ(image.updated, 1);
    for (std::size_t k = 0; k < image.values.size(); ++k)
        ASSERT_EQ(image.values[k], solver.image().values[k] * static_cast<float>(2 + k % 3));
}

TEST(LiveTest, WithoutAViewerARunGoesOnAndHearsItOnce) {
    const TakenPort port;
    const std::string nobody = port.address();
    Notes notes;
    {
        Live live(nobody, "run", notes.hear());
        live.show("image", make_image(8, 8, 3));
        while (notes.heard().empty()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        for (int i = 0; i < 12; ++i) {  // it is tried again after a second
            live.show("image", make_image(8, 8, 3));
            std::this_thread::sleep_for(std::chrono::milliseconds(100));
        }
    }
    ASSERT_EQ(notes.heard().size(), 1u);
    EXPECT_EQ(notes.heard()[0], "no viewer takes images at " + nobody +
                                    " (Connection refused): nothing is shown until one does");
}

TEST(LiveTest, AViewerThatTakesNothingHoldsNothingUp) {
    Receiver receiver(Receiver::Manner::kTakesNothing);
    Notes notes;
    const Image image = make_image(2000, 1000, 3);
    auto live = std::make_unique<Live>(receiver.address(), "run", notes.hear());
    int shown = 0;
    for (; notes.heard().empty(); ++shown) {  // for two seconds without a byte
        live->show("image", image);
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    EXPECT_GT(shown, 4) << "one that waits for the viewer is the only one before the note";
    live.reset();
    EXPECT_EQ(notes.heard().size(), 1u);
}

/// The threads of this process.
std::set<std::string> threads() {
    std::set<std::string> all;
    for (const auto& entry : std::filesystem::directory_iterator("/proc/self/task"))
        all.insert(entry.path().string());
    return all;
}

/// Live waits for a second, its thread for two after the last byte; on a busy machine the thread
/// may be the first.
TEST(LiveTest, ItsEndTellsOfAViewerThatTakesNothingAndNobodyHearsOfItLater) {
    bool told_at_end = false;
    for (int attempt = 0; attempt < 20 && !told_at_end; ++attempt) {
        Receiver receiver(Receiver::Manner::kTakesNothing);
        Notes notes;
        std::set<std::string> own;
        {
            const std::set<std::string> others = threads();
            Live live(receiver.address(), "run", notes.hear());
            for (const std::string& thread : threads())
                if (!others.contains(thread)) own.insert(thread);
            live.show("image", make_image(2000, 1000, 3));
        }
        ASSERT_EQ(notes.heard().size(), 1u);
        told_at_end =
            notes.heard()[0] == "the viewer at " + receiver.address() +
                                    " was too slow for the last images: not all of them are shown";
        ASSERT_EQ(own.size(), 1u);
        while (threads().contains(*own.begin()))
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        EXPECT_EQ(notes.heard().size(), 1u);
    }
    EXPECT_TRUE(told_at_end);
}

TEST(LiveTest, WaitsForANoteThatIsUnderWay) {
    const TakenPort nobody;
    std::atomic<bool> has_begun = false, has_ended = false;
    {
        Live live(nobody.address(), "run", [&](const std::string&) {
            has_begun = true;
            std::this_thread::sleep_for(std::chrono::milliseconds(1200));
            has_ended = true;
        });
        live.show("image", make_image(8, 8, 3));
        while (!has_begun) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    EXPECT_TRUE(has_ended);
}

TEST(LiveTest, AViewerThatComesBackIsShownEverything) {
    const TakenPort taken;
    auto first = std::make_unique<Receiver>(Receiver::Manner::kReads, taken.port);
    Notes notes;
    Live live(first->address(), "run", notes.hear());
    live.show("image", make_image(4, 4, 3, 0.5f));
    EXPECT_TRUE(first->sees([](const Viewer& v) { return has_last(v, "run/image", 0.5f); }));
    first.reset();
    Receiver second(Receiver::Manner::kReads, taken.port);
    std::this_thread::sleep_for(std::chrono::milliseconds(300));  // until its end has arrived
    live.show("image", make_image(4, 4, 3, 1.0f));
    EXPECT_TRUE(second.sees([](const Viewer& v) { return has_last(v, "run/image", 1.0f); }));
    EXPECT_TRUE(notes.heard().empty()) << notes.heard()[0];
}

TEST(LiveTest, AForkOfTheProcessShowsNothingAndEnds) {
    Receiver receiver;
    auto live = std::make_unique<Live>(receiver.address());
    live->show("image", make_image(4, 4, 3));
    const pid_t child = fork();
    if (child == 0) {
        live->show("image", make_image(4, 4, 3));
        live.reset();
        _exit(0);
    }
    int status = -1;
    EXPECT_LT(seconds_of([&] { waitpid(child, &status, 0); }), 5.0);
    EXPECT_EQ(status, 0);
    EXPECT_TRUE(receiver.sees([](const Viewer& v) {
        const auto found = v.images.find("burnish/image");
        return found != v.images.end() && found->second.updated > 0;
    }));
    live.reset();
    EXPECT_EQ(receiver.stop().images.at("burnish/image").updated, 1);
}

/// Whatever its thread held when the process was forked is held for ever.
TEST(LiveTest, AForkOfTheProcessKnowsOfNothingShown) {
    Receiver receiver;
    Sender sender(parse_address(receiver.address(), {}), {});
    sender.push({Message::Kind::kShow, "image", make_image(400, 400, 3)});
    EXPECT_TRUE(receiver.sees([&](const Viewer&) { return sender.is_idle(); }));
    EXPECT_TRUE(sender.has_shown("image"));
    EXPECT_GT(sender.cost(), 0);
    const pid_t child = fork();
    if (child == 0) _exit(sender.has_shown("image") || sender.cost() > 0 || sender.is_idle());
    int status = -1;
    waitpid(child, &status, 0);
    EXPECT_EQ(status, 0);
}

}  // namespace
}  // namespace burnish
