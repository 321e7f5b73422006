#pragma once
/// HTTP to a program on this machine.

#include <optional>
#include <string>

namespace luxrig {

struct HttpAnswer {
  int status = 0;
  std::string body;
};

/// Address of a program: a Unix socket if one is named, else the port.
struct HttpPeer {
  std::string host = "127.0.0.1";
  int port = 0;
  std::string socket{};
  std::string token{};  ///< sent unless empty
};

/// A program listens on that Unix socket.
[[nodiscard]] bool http_listens(const std::string& socket);

/// Nothing without an answer within 2 s (connecting) or `wait_s` (the answer).
[[nodiscard]] std::optional<HttpAnswer> http_get(const HttpPeer& peer, const std::string& route, int wait_s = 5);
[[nodiscard]] std::optional<HttpAnswer> http_post_json(const HttpPeer& peer, const std::string& route,
                                                       const std::string& body, int wait_s = 5);

}  // namespace luxrig
