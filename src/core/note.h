// What another thread says, kept until somebody asks for it.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

namespace burnish {

class Note {
  public:
    /// To be called from the other thread, which may outlive this object.
    std::function<void(const std::string&)> hear() const {
        return [kept = kept_](const std::string& text) {
            const std::lock_guard lock(kept->mutex);
            kept->text = text;
        };
    }
    /// Empty: nothing since the last call.
    std::string take() const {
        const std::lock_guard lock(kept_->mutex);
        return std::exchange(kept_->text, {});
    }

  private:
    struct Kept {
        std::mutex mutex = {};
        std::string text = {};
    };
    std::shared_ptr<Kept> kept_ = std::make_shared<Kept>();
};

}  // namespace burnish
