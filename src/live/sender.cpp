#include "live/sender.h"

#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "live/packets.h"

namespace burnish {

namespace {

using Clock = std::chrono::steady_clock;
using Size = std::array<int, 3>;

constexpr auto kUntilRetry = std::chrono::seconds(1);
constexpr auto kUntilAbandoned = std::chrono::seconds(1);
/// Of the values in a packet: between packets the thread hears that it is to end.
constexpr std::size_t kPacketValues = 1 << 18;

double processor_seconds() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace

struct Sender::Shared {
    Address address;
    std::function<void(const std::string&)> note;
    pid_t process = getpid();  ///< which has the thread: a fork of it has none
    std::atomic<bool> abandoned = false;

    std::mutex mutex = {};  ///< guards the rest
    std::condition_variable changed = {};
    std::vector<Message> queue = {};
    bool busy = false, closed = false;
    bool telling = false;                    ///< the note is called, without the lock
    std::map<std::string, Size> shown = {};  ///< images that the viewer has
    Clock::time_point retry = {};            ///< no viewer is looked for before
    double cost = 0;
};

namespace {

/// Sends what the messages say, through a connection that it makes where there is none.
template <class Shared>
class Batch {
  public:
    Batch(Shared& shared, std::optional<Connection>& connection)
        : shared_(shared), connection_(connection) {}

    void send(const Message& message) {
        if (!connection_) connection_.emplace(shared_.address);
        switch (message.kind) {
            case Message::Kind::kShow:
                return show(message);
            case Message::Kind::kClose:
                return close(message);
            case Message::Kind::kOpen:
                return connection_->send(open_packet(message.name));
        }
    }

  private:
    void show(const Message& m) {
        const Image& image = m.image;
        const Size size{image.width, image.height, image.channels};
        bool is_first = false;
        if (!has(m.name, size, is_first)) connection_->send(create_packet(m.name, image, is_first));
        const std::size_t row = image.index(0, 1);
        const int rows = static_cast<int>(std::max<std::size_t>(1, kPacketValues / row));
        for (int y = 0; y < image.height && !shared_.abandoned; y += rows)
            connection_->send(update_packet(m.name, image, y, std::min(rows, image.height - y)));
        const std::lock_guard lock(shared_.mutex);
        shared_.shown[m.name] = size;
    }

    bool has(const std::string& name, const Size& size, bool& is_first) const {
        const std::lock_guard lock(shared_.mutex);
        is_first = shared_.shown.empty();
        const auto found = shared_.shown.find(name);
        return found != shared_.shown.end() && found->second == size;
    }

    void close(const Message& m) {
        connection_->send(close_packet(m.name));
        const std::lock_guard lock(shared_.mutex);
        shared_.shown.erase(m.name);
    }

    Shared& shared_;
    std::optional<Connection>& connection_;
};

/// The viewer is not there, or not any more.
template <class Shared>
void give_up(Shared& s, std::unique_lock<std::mutex>& lock, const std::string& reason) {
    s.queue.clear();
    s.shown.clear();
    s.retry = Clock::now() + kUntilRetry;
    auto note = std::exchange(s.note, nullptr);
    if (!note) return;
    s.telling = true;
    lock.unlock();
    try {
        note("no viewer takes images at " + s.address.host + ":" + s.address.port + " (" + reason +
             "): nothing is shown until one does");
    } catch (...) {  // nobody waits for this thread
    }
    note = nullptr;  // what it holds goes, too, before the sender may
    lock.lock();
    s.telling = false;
}

/// What is wrong; empty: nothing.
template <class Shared>
std::string send_all(Shared& s, const std::vector<Message>& messages,
                     std::optional<Connection>& connection) {
    try {
        Batch batch(s, connection);
        for (const Message& m : messages)
            if (!s.abandoned) batch.send(m);
        return {};
    } catch (const std::exception& e) {
        connection.reset();
        return e.what();
    }
}

/// The thread.
template <class Shared>
void serve(const std::shared_ptr<Shared>& s) {
    std::optional<Connection> connection;
    std::unique_lock lock(s->mutex);
    while (true) {
        s->changed.wait(lock, [&] { return s->closed || !s->queue.empty(); });
        if (s->queue.empty() || s->abandoned) return;
        const std::vector<Message> messages = std::exchange(s->queue, {});
        if (Clock::now() >= s->retry) {
            s->busy = true;
            lock.unlock();
            const double begin = processor_seconds();
            const std::string wrong = send_all(*s, messages, connection);
            const double cost = processor_seconds() - begin;
            lock.lock();
            s->cost = cost;
            if (!wrong.empty()) give_up(*s, lock, wrong);
            s->busy = false;
        }
        s->changed.notify_all();
    }
}

}  // namespace

Sender::Sender(Address address, std::function<void(const std::string&)> note)
    : shared_(new Shared{std::move(address), std::move(note)}) {
    std::thread([shared = shared_] { serve(shared); }).detach();
}

Sender::~Sender() {
    Shared& s = *shared_;
    if (s.process != getpid()) return;
    std::function<void(const std::string&)> unheard;  // what it holds goes without the lock
    std::unique_lock lock(s.mutex);
    s.closed = true;
    s.changed.notify_all();
    s.changed.wait_for(lock, kUntilAbandoned, [&] { return s.queue.empty() && !s.busy; });
    s.abandoned = true;
    unheard = std::exchange(s.note, nullptr);
    s.changed.wait(lock, [&] { return !s.telling; });
}

void Sender::push(Message message) {
    Shared& s = *shared_;
    if (s.process != getpid()) return;
    const std::lock_guard lock(s.mutex);
    std::erase_if(s.queue, [&](const Message& m) { return m.name == message.name; });
    s.queue.push_back(std::move(message));
    s.changed.notify_all();
}

bool Sender::is_idle() const {
    Shared& s = *shared_;
    if (s.process != getpid()) return false;
    const std::lock_guard lock(s.mutex);
    return s.queue.empty() && !s.busy && Clock::now() >= s.retry;
}

bool Sender::has_shown(const std::string& name) const {
    Shared& s = *shared_;
    if (s.process != getpid()) return false;
    const std::lock_guard lock(s.mutex);
    return s.shown.count(name) > 0;
}

double Sender::cost() const {
    Shared& s = *shared_;
    if (s.process != getpid()) return 0;
    const std::lock_guard lock(s.mutex);
    return s.cost;
}

}  // namespace burnish
