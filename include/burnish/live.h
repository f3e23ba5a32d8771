// A run beside its viewer: images are sent to a running tev (github.com/Tom94/tev) by its protocol.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "burnish/solve.h"

namespace burnish {

/// Sends images to a viewer, from a thread of its own: no call waits for the viewer. What it does
/// not take is left out; where there is none, it is looked for again every second.
class Live {
  public:
    /// Where tev listens unless it is told otherwise.
    static constexpr const char* kAddress = "127.0.0.1:14158";

    /// address: "HOST:PORT", "HOST" or ":PORT". Images are named "title/name". note: hears once, in
    /// a sentence, why images are not shown; from the other thread or from the destructor, never
    /// after it, and does not call it; what it throws is dropped. Throws InputError: no address.
    explicit Live(const std::string& address = kAddress, std::string title = "burnish",
                  std::function<void(const std::string&)> note = {});
    Live(Live&&) noexcept;
    Live& operator=(Live&&) = delete;
    /// Waits until everything is sent, a second at most, and for a note that is under way.
    ~Live();

    /// Shows an image of 1 to 4 channels, in the place of the one of that name: of more than 2^22
    /// pixels every k-th alone, in both directions. One without values is passed over. Throws
    /// InputError for other channels, and for another number of values.
    void show(const std::string& name, Image image);
    /// What show() has shown goes away.
    void close(const std::string& name);
    /// Shows an image file of the machine on which the viewer runs.
    void open(const std::string& path);

    /// Shows the present textures and, beside the pictures, the images of views, a few at a time
    /// where there are many. Does nothing where it was called lately: it takes 2 % of the time at
    /// most.
    void update(const Solver& solver);
    /// Shows what a run of solve() has found of this problem.
    void show(const Problem& problem, const Summary& summary);
    /// The same without textures: of each view its picture and its image. views: those of the
    /// problem. Throws InputError: there are fewer than in the result.
    void show(const std::vector<View>& views, const Evaluation& result);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace burnish
