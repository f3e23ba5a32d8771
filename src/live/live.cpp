#include "burnish/live.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "core/require.h"
#include "image/whole.h"
#include "live/sender.h"
#include "optimize/view_loss.h"
#include "optimize/views.h"

namespace burnish {

namespace {

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

constexpr double kPeriod = 0.2;           ///< seconds between two updates, at least
constexpr double kCostFactor = 50;        ///< of an update's seconds: 2 % of the time
constexpr std::size_t kPixels = 1 << 22;  ///< of an image, and about as many of an update's views

std::size_t pixels_of(const Image& image) {
    return image.index(0, image.height) / std::max(1, image.channels);
}

/// Of a large image every k-th pixel: copies are small.
Image shown(Image image) {
    int k = 1;
    while (pixels_of(image) / static_cast<std::size_t>(k * k) > kPixels) ++k;
    if (k == 1) return image;
    Image copy = make_image((image.width + k - 1) / k, (image.height + k - 1) / k, image.channels);
    for (int y = 0; y < copy.height; ++y)
        for (int x = 0; x < copy.width; ++x)
            for (int c = 0; c < copy.channels; ++c) copy.at(x, y, c) = image.at(k * x, k * y, c);
    return copy;
}

}  // namespace

struct Live::Impl {
    Sender sender;
    std::string title;
    Clock::time_point next = {};  ///< when update() does something again
    std::size_t next_view = 0;

    /// Checks it before it is made smaller.
    void show(const std::string& name, Image image) {
        if (image.values.empty()) return;
        if (image.channels < 1 || image.channels > 4 || !is_whole(image))
            throw InputError(
                fmt::format("the image \"{}\" has {} channels and {} values for {} x {} pixels: "
                            "expected 1 to 4 channels, and one value for each channel of a pixel",
                            name, image.channels, image.values.size(), image.width, image.height));
        sender.push({Message::Kind::kShow, title + "/" + name, shown(std::move(image))});
    }

    /// The picture and the image beside it; returns how many pixels it was.
    std::size_t show_view(const std::vector<View>& views, std::size_t v, const Image& image,
                          const ExposureFactors& exposure) {
        if (image.width == 0) return 0;
        const View& view = views[v];
        const std::string name = name_of(view, v), picture = name + " picture";
        if (!sender.has_shown(title + "/" + picture)) show(picture, view.image);
        show(name, exposed(exposure, shown(image)));
        return pixels_of(image);
    }
};

Live::Live(const std::string& address, std::string title,
           std::function<void(const std::string&)> note) {
    const std::string missing = kAddress;
    const std::size_t colon = missing.find(':');
    impl_.reset(
        new Impl{{parse_address(address, {missing.substr(0, colon), missing.substr(colon + 1)}),
                  std::move(note)},
                 std::move(title)});
}
Live::Live(Live&&) noexcept = default;
Live::~Live() = default;

void Live::show(const std::string& name, Image image) { impl_->show(name, std::move(image)); }
void Live::close(const std::string& name) {
    impl_->sender.push({Message::Kind::kClose, impl_->title + "/" + name});
}
void Live::open(const std::string& path) { impl_->sender.push({Message::Kind::kOpen, path}); }

void Live::update(const Solver& solver) {
    const Clock::time_point begin = Clock::now();
    if (begin < impl_->next || !impl_->sender.is_idle()) return;
    const Problem& problem = solver.problem();
    for (std::size_t i = 0; i < problem.unknowns.size(); ++i)
        impl_->show(problem.unknowns[i].name, solver.texture(i));
    std::size_t pixels = 0;
    for (std::size_t n = 0; n < problem.views.size() && pixels < kPixels; ++n) {
        const std::size_t v = impl_->next_view++ % problem.views.size();
        pixels += impl_->show_view(problem.views, v, solver.image(v), solver.exposure(v));
    }
    const Clock::time_point end = Clock::now();
    const double cost = Seconds(end - begin).count() + impl_->sender.cost();
    impl_->next = end + std::chrono::duration_cast<Clock::duration>(
                            Seconds(std::max(kPeriod, kCostFactor * cost)));
}

void Live::show(const Problem& problem, const Summary& summary) {
    for (std::size_t i = 0; i < summary.textures.size(); ++i)
        impl_->show(problem.unknowns[i].name, summary.textures[i].values);
    show(problem.views, summary.result);
}

void Live::show(const std::vector<View>& views, const Evaluation& result) {
    require(result.views.size() <= views.size(),
            fmt::format("the result has {} views: expected at most those of the problem, {}",
                        result.views.size(), views.size()));
    for (std::size_t v = 0; v < result.views.size(); ++v)
        impl_->show_view(views, v, result.views[v].image, result.views[v].exposure);
}

}  // namespace burnish
