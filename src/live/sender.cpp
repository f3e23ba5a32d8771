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

struct SenderState {
    Address address;
    std::function<void(const std::string&)> note;
    pid_t process = getpid();  ///< which has the thread: a fork of it has none
    std::atomic<bool> abandoned = false;

    std::mutex mutex = {};  ///< guards the rest, but the thread reads `shown` without it
    std::condition_variable changed = {};
    std::vector<Message> queue = {};
    bool busy = false, closed = false;
    bool telling = false;  ///< the note is called, without the lock
    /// Images that the viewer has. The thread alone writes it.
    std::map<std::string, Size> shown = {};
    Clock::time_point retry = {};  ///< no viewer is looked for before
    double cost = 0;
};

namespace {

/// Sends what the messages say, through a connection that it makes where there is none.
class Batch {
  public:
    Batch(SenderState& state, std::optional<Connection>& connection)
        : state_(state), connection_(connection) {}

    void send(const Message& message) {
        if (!connection_) connection_.emplace(state_.address);
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
        const auto found = state_.shown.find(m.name);
        if (found == state_.shown.end() || found->second != size)
            connection_->send(create_packet(m.name, image, state_.shown.empty()));
        const std::size_t row = image.index(0, 1);
        const int rows = static_cast<int>(std::max<std::size_t>(1, kPacketValues / row));
        for (int y = 0; y < image.height && !state_.abandoned; y += rows)
            connection_->send(update_packet(m.name, image, y, std::min(rows, image.height - y)));
        const std::lock_guard lock(state_.mutex);
        state_.shown[m.name] = size;
    }

    void close(const Message& m) {
        connection_->send(close_packet(m.name));
        const std::lock_guard lock(state_.mutex);
        state_.shown.erase(m.name);
    }

    SenderState& state_;
    std::optional<Connection>& connection_;
};

void tell(const std::function<void(const std::string&)>& note, const std::string& text) {
    try {
        note(text);
    } catch (...) {  // nobody waits for the thread, and destructors throw nothing
    }
}

std::string text_of(const Address& address) { return address.host + ":" + address.port; }

/// The viewer is not there, or not any more.
void give_up(SenderState& s, std::unique_lock<std::mutex>& lock, const std::string& reason) {
    s.queue.clear();
    s.shown.clear();
    s.retry = Clock::now() + kUntilRetry;
    auto note = std::exchange(s.note, nullptr);
    if (!note) return;
    s.telling = true;
    lock.unlock();
    tell(note, "no viewer takes images at " + text_of(s.address) + " (" + reason +
                   "): nothing is shown until one does");
    note = nullptr;  // what it holds goes, too, before the sender may
    lock.lock();
    s.telling = false;
}

/// A viewer that comes in the place of one that has gone has no images.
void drop_ended(SenderState& s, std::optional<Connection>& connection) {
    if (!connection || !connection->has_ended()) return;
    connection.reset();
    const std::lock_guard lock(s.mutex);
    s.shown.clear();
}

/// What is wrong; empty: nothing.
std::string send_all(SenderState& s, const std::vector<Message>& messages,
                     std::optional<Connection>& connection) {
    try {
        drop_ended(s, connection);
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
void serve(const std::shared_ptr<SenderState>& s) {
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
    : state_(new SenderState{std::move(address), std::move(note)}) {
    std::thread([state = state_] { serve(state); }).detach();
}

Sender::~Sender() {
    SenderState& s = *state_;
    if (s.process != getpid()) return;
    std::unique_lock lock(s.mutex);
    s.closed = true;
    s.changed.notify_all();
    const bool is_sent =
        s.changed.wait_for(lock, kUntilAbandoned, [&] { return s.queue.empty() && !s.busy; });
    s.abandoned = true;
    const auto note = std::exchange(s.note, nullptr);
    s.changed.wait(lock, [&] { return !s.telling; });
    lock.unlock();  // what the note holds goes without it
    if (note && !is_sent)
        tell(note, "the viewer at " + text_of(s.address) +
                       " was too slow for the last images: not all of them are shown");
}

void Sender::push(Message message) {
    SenderState& s = *state_;
    if (s.process != getpid()) return;
    const std::lock_guard lock(s.mutex);
    std::erase_if(s.queue, [&](const Message& m) { return m.name == message.name; });
    s.queue.push_back(std::move(message));
    s.changed.notify_all();
}

bool Sender::is_idle() const {
    SenderState& s = *state_;
    if (s.process != getpid()) return false;
    const std::lock_guard lock(s.mutex);
    return s.queue.empty() && !s.busy && Clock::now() >= s.retry;
}

bool Sender::has_shown(const std::string& name) const {
    SenderState& s = *state_;
    if (s.process != getpid()) return false;
    const std::lock_guard lock(s.mutex);
    return s.shown.count(name) > 0;
}

double Sender::cost() const {
    SenderState& s = *state_;
    if (s.process != getpid()) return 0;
    const std::lock_guard lock(s.mutex);
    return s.cost;
}

}  // namespace burnish
