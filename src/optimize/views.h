// The views of a problem and how they are rendered.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "burnish/solve.h"
#include "core/at_place.h"

namespace burnish {

struct Scene;

/// The image of the scene's environment map; none: it has no such map.
SharedImage sky_of(const Scene& scene);

/// A renderer of a view. earlier: of all views before it, with which it shares equal lights. Images
/// are not looked at. Throws InputError, which names the view, where a camera or light does not
/// fit.
Renderer make_view(const Problem& problem, std::size_t view, const std::vector<Renderer>& earlier);
/// Of all views.
std::vector<Renderer> make_views(const Problem& problem);

/// Masks the blind pixels of each view. Throws InputError, which names the view, where an image,
/// mask or exposure does not fit, and where no pixel of those that are fitted counts.
void check_pictures(Problem& problem, const std::vector<Renderer>& views);

/// Gives the weight 0 to the pixels that filtering reaches from outside of the field of the view's
/// lens, where nothing is seen. renderer: of the view. Returns the share of the pixels.
double mask_blind_pixels(const Renderer& renderer, View& view);

/// Gives the weight 0 to the pixels that show no surface of the scene, or the edge of one.
/// renderer: of the view. Returns the share of the pixels. Throws InputError where the image or the
/// mask does not fit, the camera has an aperture, no other pixel is left, or each of these has the
/// weight 0.
double mask_background(const Renderer& renderer, View& view);

/// Throws InputError where there is none.
std::vector<std::size_t> fitted_views(const Problem& problem);

/// The first rank that has a part of each view: fitted ones and those that are held out, each in
/// order. Throws InputError where an iteration that visits `batch` views leaves processes without
/// one, and more views would not.
std::vector<int> owners_of_views(const Problem& problem, std::size_t batch);

/// The name that messages have for a view.
std::string name_of(const View& view, std::size_t number);

/// Returns body(). Its InputErrors name the view, unless it is the only one and has no name.
template <class Body>
auto naming_view(const View& view, std::size_t number, std::size_t views, const Body& body) {
    return at_place(views == 1 && view.name.empty() ? "" : name_of(view, number), body);
}

/// The view of that name; names: of all. Throws InputError, which names those there are, where
/// there is none. option: that gives the name, in messages.
std::size_t find_view(const std::vector<std::string>& names, const std::string& name,
                      const std::string& option);

/// A seed for the random numbers of each view; that of the first one is the run's.
std::uint32_t seed_of_view(std::uint32_t seed, std::size_t view);

}  // namespace burnish
