#include "live/connection.h"

#include <fcntl.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <utility>

#include "burnish/error.h"

namespace burnish {

namespace {

constexpr int kPatienceMilliseconds = 2000;

/// The error with which the socket can be written, 0: none.
int wait_to_write(int socket) {
    pollfd waited{socket, POLLOUT, 0};
    int ready = 0;
    do {
        ready = poll(&waited, 1, kPatienceMilliseconds);
    } while (ready < 0 && errno == EINTR);
    if (ready < 0) return errno;
    return ready == 0 ? ETIMEDOUT : 0;
}

/// The error of a connection that is made, 0: none.
int connect_in_time(int socket, const addrinfo& to) {
    if (connect(socket, to.ai_addr, to.ai_addrlen) == 0) return 0;
    if (errno != EINPROGRESS) return errno;
    if (const int error = wait_to_write(socket)) return error;
    int error = 0;
    socklen_t size = sizeof error;
    return getsockopt(socket, SOL_SOCKET, SO_ERROR, &error, &size) == 0 ? error : errno;
}

using Addresses = std::unique_ptr<addrinfo, decltype(&freeaddrinfo)>;

Addresses addresses_of(const Address& address) {
    addrinfo hints{};
    hints.ai_socktype = SOCK_STREAM;
    addrinfo* found = nullptr;
    if (const int error = getaddrinfo(address.host.c_str(), address.port.c_str(), &hints, &found))
        throw ResourceError(gai_strerror(error));
    return {found, &freeaddrinfo};
}

bool is_port(const std::string& text) {
    return !text.empty() && text.size() <= 5 &&
           text.find_first_not_of("0123456789") == std::string::npos && std::stoi(text) >= 1 &&
           std::stoi(text) <= 65535;
}

}  // namespace

Address parse_address(const std::string& text, const Address& missing) {
    const std::size_t bracket = text.rfind(']');
    const std::size_t colon = text.find(':', bracket == std::string::npos ? 0 : bracket);
    const std::size_t end = std::min(colon, text.size());  // of the host
    Address address{text.substr(0, end), missing.port};
    if (colon != std::string::npos) address.port = text.substr(colon + 1);
    if (address.host.starts_with('[') && bracket + 1 == end && end > 2)
        address.host = text.substr(1, bracket - 1);
    if (address.host.empty()) address.host = missing.host;
    if (text.empty() || !is_port(address.port) ||
        address.host.find_first_of("[]/ ") != std::string::npos)
        throw InputError("found '" + text + "', expected HOST:PORT with a port from 1 to 65535");
    return address;
}

Connection::Connection(const Address& address) {
    int error = 0;
    const Addresses all = addresses_of(address);
    for (const addrinfo* a = all.get(); a; a = a->ai_next) {
        socket_ = socket(a->ai_family, a->ai_socktype | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
        error = socket_ < 0 ? errno : connect_in_time(socket_, *a);
        if (error == 0) return;
        if (socket_ >= 0) close(std::exchange(socket_, -1));
    }
    throw ResourceError(std::strerror(error));
}

Connection::~Connection() {
    if (socket_ >= 0) close(socket_);
}

void Connection::send(std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
        if (sent > 0) {
            bytes.remove_prefix(static_cast<std::size_t>(sent));
        } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
            if (const int error = wait_to_write(socket_)) throw ResourceError(std::strerror(error));
        } else if (errno != EINTR) {
            throw ResourceError(std::strerror(errno));
        }
    }
}

bool Connection::has_ended() const {
    char byte = 0;
    const ssize_t came = recv(socket_, &byte, 1, MSG_PEEK | MSG_DONTWAIT);
    return came == 0 || (came < 0 && errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR);
}

}  // namespace burnish
