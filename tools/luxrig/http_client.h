#pragma once
/// HTTP to a program on loopback. Apart from everything else because the library's system headers define
/// macros (`_res`) that Eigen does not survive.

#include <optional>
#include <string>

namespace luxrig {

struct HttpAnswer {
  int status = 0;
  std::string body;
};

/// Nothing when nobody answers within 2 s (connecting) or `wait_s` (reading).
[[nodiscard]] std::optional<HttpAnswer> http_get(const std::string& host, int port, const std::string& route,
                                                 int wait_s = 5);
[[nodiscard]] std::optional<HttpAnswer> http_post_json(const std::string& host, int port, const std::string& route,
                                                       const std::string& body, int wait_s = 5);

}  // namespace luxrig
