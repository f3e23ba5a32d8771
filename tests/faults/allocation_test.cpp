// Memory that runs out: the n-th allocation of a short run fails, for any n. What is thrown says
// so, nothing of ours is leaked, and the next run is as if nothing had been. (OpenEXR leaks a
// little where its own allocations fail; Embree 3.13 can end the process at a later ray, so what it
// asks for itself is spared.)
#include <dlfcn.h>
#include <execinfo.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <new>
#include <string>

#include "burnish/burnish.h"
#include "cli/program.h"
#include "core/parallel.h"

namespace {

std::atomic<long> live{0};     ///< allocations
std::atomic<long> asked{0};    ///< since the last call of fail_at
std::atomic<long> failing{0};  ///< of these; 0: none
bool is_ours = false;          ///< the one that failed
std::size_t failed_bytes = 0;  ///< of it

const char* file_of(const void* address) {
    Dl_info info;
    return dladdr(address, &info) != 0 ? info.dli_fname : "";
}

/// Who asks for memory.
struct Asker {
    bool ours = false;  ///< this program, by itself or through the standard library
    bool embree = false;
};

/// caller: of operator new.
Asker asker_of(void* caller) {
    void* frames[32];
    void** const end = frames + backtrace(frames, 32);
    const std::string own = file_of(reinterpret_cast<const void*>(&asker_of));
    const auto is_of = [](void* frame, const char* library) {
        return std::strstr(file_of(frame), library) != nullptr;
    };
    void** const asks = std::find_if(std::find(frames, end, caller), end,
                                     [&](void* frame) { return !is_of(frame, "libstdc++"); });
    return {asks != end && own == file_of(*asks),
            std::any_of(frames, end, [&](void* frame) { return is_of(frame, "libembree"); })};
}

void* allocate(std::size_t size, std::size_t alignment, void* caller) {
    if (++asked == failing) {
        failing = 0;  // a backtrace may ask for memory
        failed_bytes = size;
        const Asker asker = asker_of(caller);
        is_ours = asker.ours;
        if (!asker.embree) throw std::bad_alloc();
    }
    size = (std::max<std::size_t>(size, 1) + alignment - 1) / alignment * alignment;
    void* const p = std::aligned_alloc(alignment, size);
    if (!p) throw std::bad_alloc();
    ++live;
    return p;
}

void release(void* p) {
    if (p) --live;
    std::free(p);
}

void fail_at(long n) { asked = 0, failing = n; }

}  // namespace

// The others of the standard library call these.
void* operator new(std::size_t size) {
    return allocate(size, alignof(std::max_align_t), __builtin_return_address(0));
}
void* operator new(std::size_t size, std::align_val_t alignment) {
    return allocate(size, static_cast<std::size_t>(alignment), __builtin_return_address(0));
}
/// The standard library's would do; a sanitizer's has memory of its own.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
    try {
        return allocate(size, alignof(std::max_align_t), __builtin_return_address(0));
    } catch (const std::bad_alloc&) {
        return nullptr;
    }
}
void operator delete(void* p) noexcept { release(p); }
void operator delete(void* p, std::size_t) noexcept { release(p); }
void operator delete(void* p, std::align_val_t) noexcept { release(p); }
void operator delete(void* p, std::size_t, std::align_val_t) noexcept { release(p); }

namespace burnish {
namespace {

class Allocations : public testing::Program {
  protected:
    /// With textures that are not read by OpenEXR, which leaks where its own allocations fail.
    Allocations() {
        write_scene();
        std::string scene = testing::read_text(folder / "scene.xml");
        for (const std::string name : {"color", "roughness"}) {
            write_image(folder / (name + ".pfm"), read_image((folder / (name + ".exr")).string()),
                        false);
            scene.replace(scene.find(name + ".exr"), name.size() + 4, name + ".pfm");
        }
        testing::write_text(folder / "scene.xml", scene);
    }

    struct ShortRun {
        std::string state;           ///< after two iterations
        bool is_step_again = false;  ///< memory ended in a step, which was done again
    };

    ShortRun short_run(const Estimator& estimator) const {
        const Renderer renderer = Renderer::load((folder / "scene.xml").string());
        View view;
        view.image = renderer.render(2);
        Problem problem{renderer, {std::move(view)}, {{"base_color", 0.5f}, {"roughness", 0.5f}}};
        Options options;
        options.estimator = estimator;
        Solver solver(std::move(problem), options);
        ShortRun run;
        while (solver.iterations() < 2) {
            try {
                solver.step();
            } catch (const std::bad_alloc&) {
                run.is_step_again = true;
            }
        }
        solver.recovered();
        run.state = save_state(solver.state());
        return run;
    }

    /// Of which every `stride`-th fails in turn.
    void expect_safe(const Estimator& estimator, long stride) const {
        const ThreadLimit one(1);  // so that the n-th is the same each time
        const std::string bytes = short_run(estimator).state;
        short_run(estimator);
        long before = live;
        fail_at(0);
        short_run(estimator);
        const long all = asked;
        ASSERT_EQ(live, before) << "a run leaks where nothing fails";
        ASSERT_GT(all, 1000);
        long failed = 0, ours = 0, again = 0;
        for (long n = 1; n <= all; n += stride) {
            fail_at(n);
            try {
                const ShortRun run = short_run(estimator);
                again += run.is_step_again;
                ASSERT_TRUE(run.state == bytes) << "allocation " << n << " of " << all;
            } catch (const std::bad_alloc&) {
                ++failed;
            } catch (const ResourceError&) {
                ++failed;
            }
            fail_at(0);
            if (is_ours) {
                ASSERT_LE(live, before) << "allocation " << n << " of " << all;
            }
            ours += is_ours;
            before = live;
        }
        EXPECT_GT(ours, 0.5 * static_cast<double>(all / stride));
        EXPECT_GT(failed + again, 0.9 * static_cast<double>(all / stride)) << "a failure is hidden";
        EXPECT_GT(again, 0.1 * static_cast<double>(all / stride));
        EXPECT_TRUE(short_run(estimator).state == bytes);
    }

    /// All of them where BURNISH_FAULTS is set.
    static long stride(long usual) { return std::getenv("BURNISH_FAULTS") ? 1 : usual; }
};

/// The run as solve() makes it, whose last iterations' allocations fail in turn: what was done
/// before is kept.
TEST_F(Allocations, OfIterationsLoseNothing) {
    const ThreadLimit one(1);
    const Renderer renderer = Renderer::load((folder / "scene.xml").string());
    Problem problem{renderer, {}, {{"base_color", 0.5f}, {"roughness", 0.5f}}};
    problem.views.resize(1);
    problem.views[0].image = renderer.render(2);
    Options options;
    options.stop.iterations = 4, options.evaluation_samples = 2;
    Checkpoints checkpoints;
    checkpoints.folder = (folder / "c").string(), checkpoints.seconds = 3600;
    long from = 0, to = 0;  // allocations of the third iteration
    fail_at(0);
    const Summary whole = solve(problem, options, checkpoints, [&](const Iteration& i) {
        if (i.number == 1) from = asked;
        if (i.number == 2) to = asked;
        return Continue;
    });
    ASSERT_GT(to, from + 50);
    int kept = 0;
    for (long n = from + 1; n <= to; n += stride(5)) {
        std::filesystem::remove_all(folder / "c");
        std::uint32_t done = 0;
        fail_at(n);
        try {
            solve(problem, options, checkpoints, [&](const Iteration& i) {
                done = i.number + 1;
                return Continue;
            });
            fail_at(0);
            continue;  // of a library that does without
        } catch (const std::bad_alloc&) {
        } catch (const ResourceError&) {
        }
        fail_at(0);
        if (!std::filesystem::exists(folder / "c") || std::filesystem::is_empty(folder / "c")) {
            EXPECT_LT(failed_bytes, 512u) << "allocation " << n;  // in the midst of the step
            continue;
        }
        ++kept;
        Checkpoint last = load_checkpoint(checkpoints.folder);
        ASSERT_EQ(last.run.counts.iterations, done) << "allocation " << n;
        const Summary end = solve(problem, options, std::move(last), checkpoints);
        ASSERT_TRUE(end.state == whole.state) << "allocation " << n;
    }
    EXPECT_GT(kept, 0);
}

TEST_F(Allocations, OfThePathCacheMayFail) { expect_safe(PathCache{}, stride(7)); }
TEST_F(Allocations, OfReservoirsMayFail) { expect_safe(Reservoirs{}, stride(29)); }
TEST_F(Allocations, OfMonteCarloMayFail) { expect_safe(MonteCarlo{}, stride(31)); }

}  // namespace
}  // namespace burnish
