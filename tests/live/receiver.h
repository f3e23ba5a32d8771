// A viewer of the tests: takes connections and checks every byte of tev's protocol.
#pragma once

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstring>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace burnish::testing {

/// Reads a packet's fields one after the other.
class Fields {
  public:
    explicit Fields(std::string bytes) : bytes_(std::move(bytes)) {}
    template <class Number>
    Number number() {
        Number n{};
        EXPECT_LE(at_ + sizeof n, bytes_.size());
        // Little-endian, whatever this machine is.
        for (std::size_t i = 0; i < sizeof n && at_ < bytes_.size(); ++i, ++at_)
            n |= static_cast<Number>(static_cast<Number>(static_cast<unsigned char>(bytes_[at_]))
                                     << (8 * i));
        return n;
    }
    std::string text() {
        const std::size_t end = bytes_.find('\0', at_);
        EXPECT_NE(end, std::string::npos);
        const std::string t = bytes_.substr(at_, end - at_);
        at_ = end + 1;
        return t;
    }
    bool flag() {
        const char c = bytes_.at(at_++);
        EXPECT_TRUE(c == 0 || c == 1);
        return c == 1;
    }
    std::string rest() const { return bytes_.substr(at_); }

  private:
    std::string bytes_;
    std::size_t at_ = 0;
};

/// An image as the viewer has it.
struct Received {
    int width = 0, height = 0;
    std::vector<std::string> channels;
    std::vector<float> values;  ///< [height, width, channels]
    int created = 0, updated = 0;
    bool in_front = false;
};

/// What the packets of a connection have made.
class Viewer {
  public:
    /// Whole packets are taken off the front of the bytes.
    void take(std::string& bytes) {
        while (bytes.size() >= 4) {
            const auto length = Fields(bytes.substr(0, 4)).number<std::uint32_t>();
            ASSERT_GE(length, 6u);
            if (bytes.size() < length) return;
            packets.push_back(bytes.substr(0, length));
            take_packet(Fields(bytes.substr(4, length - 4)));
            bytes.erase(0, length);
        }
    }
    std::map<std::string, Received> images;
    std::vector<std::string> packets, opened, closed;

  private:
    static std::vector<std::string> channels_of(Fields& f) {
        std::vector<std::string> names(f.number<std::uint32_t>());
        EXPECT_TRUE(names.size() >= 1 && names.size() <= 4);
        for (std::string& n : names) n = f.text();
        return names;
    }
    void take_packet(Fields f) {
        const auto kind = f.number<std::uint8_t>();
        if (kind == 7) {
            EXPECT_TRUE(f.flag());
            opened.push_back(f.text());
            EXPECT_EQ(f.text(), "");
        } else if (kind == 2) {
            closed.push_back(f.text());
            EXPECT_EQ(images.erase(closed.back()), 1u);
        } else if (kind == 4) {
            create(f);
        } else if (kind == 6) {
            return update(f);
        } else {
            ADD_FAILURE() << "packet of kind " << int{kind};
        }
        EXPECT_EQ(f.rest(), "");
    }
    void create(Fields& f) {
        const bool in_front = f.flag();
        Received& image = images[f.text()];
        image.in_front = in_front;
        image.width = static_cast<int>(f.number<std::uint32_t>());
        image.height = static_cast<int>(f.number<std::uint32_t>());
        image.channels = channels_of(f);
        image.values.assign(
            static_cast<std::size_t>(image.width * image.height) * image.channels.size(), 0.0f);
        ++image.created;
    }
    void update(Fields& f) {
        EXPECT_FALSE(f.flag());
        const std::string name = f.text();
        ASSERT_EQ(images.count(name), 1u) << name << " was not created";
        Received& image = images[name];
        const std::vector<std::string> channels = channels_of(f);
        ASSERT_EQ(channels, image.channels);
        const std::size_t count = channels.size();
        const auto x = f.number<std::uint32_t>(), y = f.number<std::uint32_t>();
        const auto width = f.number<std::uint32_t>(), height = f.number<std::uint32_t>();
        ASSERT_TRUE(x == 0 && static_cast<int>(width) == image.width &&
                    static_cast<int>(y + height) <= image.height);
        std::vector<std::uint64_t> offsets(count), strides(count);
        for (auto& o : offsets) o = f.number<std::uint64_t>();
        for (auto& s : strides) s = f.number<std::uint64_t>();
        const std::string values = f.rest();
        ASSERT_EQ(values.size(), std::size_t{width} * height * count * sizeof(float));
        for (std::size_t p = 0; p < std::size_t{width} * height; ++p)
            for (std::size_t c = 0; c < count; ++c) {
                const std::size_t at = (offsets[c] + p * strides[c]) * sizeof(float);
                ASSERT_LE(at + sizeof(float), values.size());
                std::memcpy(&image.values[(std::size_t{y} * width + p) * count + c], &values[at],
                            sizeof(float));
            }
        ++image.updated;
    }
};

/// Binds it to that port of this machine, 0: to any that is free; returns which.
inline int bind_to_port(int socket, int at) {
    const int on = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(at));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    EXPECT_EQ(bind(socket, reinterpret_cast<sockaddr*>(&address), size), 0);
    getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size);
    return ntohs(address.sin_port);
}

/// A port of this machine that is taken as long as this lives, so that no other program gets it,
/// and at which nobody listens but receivers that are given it.
class TakenPort {
  public:
    TakenPort() { port = bind_to_port(socket_, 0); }
    ~TakenPort() { close(socket_); }
    TakenPort(const TakenPort&) = delete;
    TakenPort& operator=(const TakenPort&) = delete;
    std::string address() const { return "127.0.0.1:" + std::to_string(port); }

    int port = 0;

  private:
    int socket_ = ::socket(AF_INET, SOCK_STREAM, 0);
};

/// Listens on a port of this machine.
class Receiver {
  public:
    enum class Manner { kReads, kTakesNothing };
    explicit Receiver(Manner manner = Manner::kReads, int at = 0) : manner_(manner) {
        socket_ = ::socket(AF_INET, SOCK_STREAM, 0);
        port = bind_to_port(socket_, at);
        EXPECT_EQ(listen(socket_, 4), 0);
        thread_ = std::thread([this] { serve(); });
    }
    ~Receiver() { stop(); }
    std::string address() const { return "127.0.0.1:" + std::to_string(port); }

    /// Ends and returns what was shown: after the senders have gone, all that they sent.
    Viewer& stop() {
        if (thread_.joinable()) {
            ends_ = true;
            thread_.join();
            close(socket_);
        }
        return viewer;
    }
    /// Whether it comes within a minute.
    template <class Condition>
    bool sees(const Condition& holds) {
        for (int i = 0; i < 6000; ++i) {
            {
                const std::lock_guard lock(mutex_);
                if (holds(viewer)) return true;
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
        return false;
    }

    Viewer viewer;
    int port = 0;

  private:
    /// Until the other side has closed; without one that sends, until stop().
    void serve() {
        while (true) {
            pollfd waited{socket_, POLLIN, 0};
            const bool ends = ends_;  // what comes before that is taken
            if (poll(&waited, 1, 10) == 0) {
                if (ends) return;
                continue;
            }
            const int connection = accept(socket_, nullptr, nullptr);
            receive(connection);
            close(connection);
        }
    }
    void receive(int connection) {
        std::string bytes;
        std::vector<char> block(1 << 20);
        while (true) {
            pollfd waited{connection, POLLIN, 0};
            const bool ends = ends_;
            if (manner_ == Manner::kTakesNothing || poll(&waited, 1, 10) == 0) {
                std::this_thread::sleep_for(std::chrono::milliseconds(1));
                if (ends) return;
                continue;
            }
            const ssize_t n = recv(connection, block.data(), block.size(), 0);
            if (n <= 0) break;
            bytes.append(block.data(), static_cast<std::size_t>(n));
            const std::lock_guard lock(mutex_);
            viewer.take(bytes);
        }
        EXPECT_EQ(bytes, "") << "a packet that is not whole";
    }

    Manner manner_;
    int socket_ = -1;
    std::atomic<bool> ends_ = false;
    std::mutex mutex_;
    std::thread thread_;
};

}  // namespace burnish::testing
