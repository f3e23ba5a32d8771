// A connection over TCP on which bytes go one way, in bounded time.
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
    /// Throws ResourceError where nobody accepts it within two seconds.
    explicit Connection(const Address& address);
    ~Connection();
    Connection(const Connection&) = delete;
    Connection& operator=(const Connection&) = delete;

    /// Throws ResourceError: the other side has gone, or takes nothing for two seconds.
    void send(std::string_view bytes);

  private:
    int socket_ = -1;
};

}  // namespace burnish
