// A connection over TCP on which bytes go one way. Connecting and sending take bounded time.
#pragma once

#include <string>
#include <string_view>

namespace burnish {

struct Address {
    std::string host, port;
};
/// "HOST:PORT", "HOST" or ":PORT"; the host of an IPv6 address in brackets. What is missing is
/// taken from `missing`. Throws InputError.
Address parse_address(const std::string& text, const Address& missing);

class Connection {
  public:
    /// Throws ResourceError where none of the host's addresses accepts it within two seconds each.
    /// How long looking up its name may take is the system's choice.
    explicit Connection(const Address& address);
    ~Connection();
    Connection(const Connection&) = delete;
    Connection& operator=(const Connection&) = delete;

    /// Throws ResourceError: the other side has gone, or takes nothing for two seconds.
    void send(std::string_view bytes);
    /// Whether the other side is known to have gone: what is sent then may be lost without a word.
    bool has_ended() const;

  private:
    int socket_ = -1;
};

}  // namespace burnish
