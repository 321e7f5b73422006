#pragma once
/// HTTP requests and answers, as plain values.

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace luxrig {

using HttpHeaders = std::vector<std::pair<std::string, std::string>>;

struct HttpRequest {
  std::string method, path, query;  ///< path and query as received, not decoded
  HttpHeaders headers;              ///< names in lower case
  std::string body;
  std::string credential;  ///< the sender, from HttpServerOptions::credential; empty = unknown

  /// The first header of that name (in lower case).
  [[nodiscard]] std::optional<std::string_view> header(std::string_view name) const;
  /// A query parameter, decoded; nothing if absent or not validly encoded.
  [[nodiscard]] std::optional<std::string> parameter(std::string_view name) const;
};

struct HttpResponse {
  int status = 200;
  std::string content_type = "application/json";
  std::string body;
  HttpHeaders headers{};
};

/// The path is this route's. A route that ends with a name in braces, "/api/jobs/{id}", has all paths with one more part.
[[nodiscard]] bool path_is_of(std::string_view path, std::string_view route);

/// The last part of a path.
[[nodiscard]] std::string_view last_part(std::string_view path);

/// {"error": what}
[[nodiscard]] HttpResponse http_refusal(int status, const std::string& what);

/// A regular file below the folder by a request's path, with index.html for "/"; 404 for anything else.
[[nodiscard]] HttpResponse static_file(const std::string& folder, std::string_view path);

/// Why a request is refused, whatever its path: a page of another site must not reach this program through the browser.
/// Host has to be a loopback name (against DNS rebinding), Origin the requested origin itself, Sec-Fetch-Site the same
/// origin or none. A body has to be JSON: a browser sends that to another origin only with that origin's permission.
[[nodiscard]] std::optional<HttpResponse> foreign_request(const HttpRequest& request, bool has_body);

}  // namespace luxrig
