// A thread that sends images to a viewer. What it is given waits for nothing but a lock.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "burnish/image.h"
#include "live/connection.h"

namespace burnish {

/// What the viewer is to do.
struct Message {
    enum class Kind { kShow, kClose, kOpen } kind;
    std::string name;  ///< of an image; of a file: its path
    Image image = {};
};

struct SenderState;

class Sender {
  public:
    /// note: hears once why images are not sent, from the thread or from the destructor, never
    /// after it. It does not destroy the sender.
    Sender(Address address, std::function<void(const std::string&)> note);
    /// Waits until everything is sent, a second at most, and for a note that is under way.
    ~Sender();
    Sender(const Sender&) = delete;
    Sender& operator=(const Sender&) = delete;

    /// In the place of what still waits under that name.
    void push(Message message);
    /// Whether everything was sent, and a viewer may be there.
    bool is_idle() const;
    /// Whether the viewer that is there has the image.
    bool has_shown(const std::string& name) const;
    /// The processor time that the last batch of messages took, in seconds.
    double cost() const;

  private:
    std::shared_ptr<SenderState> state_;  ///< the thread has it, too
};

}  // namespace burnish
