#pragma once
/// What is asked and answered over HTTP, as plain values.

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace luxrig {

using HttpHeaders = std::vector<std::pair<std::string, std::string>>;

struct HttpRequest {
  std::string method, path, query;  ///< path and query as they came, not decoded
  HttpHeaders headers;              ///< names in small letters
  std::string body;
  std::string credential;  ///< who asks, as HttpServerOptions::credential said; empty: nobody known

  /// The first of that name (in small letters).
  [[nodiscard]] std::optional<std::string_view> header(std::string_view name) const;
  /// Of the query, decoded; nothing when there is none, or when it is not validly encoded.
  [[nodiscard]] std::optional<std::string> parameter(std::string_view name) const;
};

struct HttpResponse {
  int status = 200;
  std::string content_type = "application/json";
  std::string body;
  HttpHeaders headers{};
};

/// {"error": what}
[[nodiscard]] HttpResponse http_refusal(int status, const std::string& what);

/// A regular file below the folder by a request's path, "/" being index.html; 404 for anything else.
[[nodiscard]] HttpResponse static_file(const std::string& folder, std::string_view path);

/// Why a request is refused whatever it asks for: a page of another site must not reach this program through the
/// browser. Host has to be a name of loopback (DNS rebinding), Origin the very origin that was asked, Sec-Fetch-Site
/// nobody else's, and a body JSON, which a browser sends to another origin only if that allows it.
[[nodiscard]] std::optional<HttpResponse> foreign_request(const HttpRequest& request, bool has_body);

}  // namespace luxrig
