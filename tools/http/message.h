#pragma once
/// HTTP requests and answers, as plain values.

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace luxrig {

using HttpHeaders = std::vector<std::pair<std::string, std::string>>;

/// Who sends a request.
struct HttpSender {
  std::string credential;  ///< tells senders apart; empty = unknown
  std::string name{};      ///< for a person
  int rank = 0;            ///< what it may do: a route says which rank it needs
};

struct HttpRequest {
  std::string method, path, query;  ///< path and query as received, not decoded
  HttpHeaders headers;              ///< names in lower case
  std::string body;
  HttpSender sender;     ///< from HttpServerOptions::sender
  std::string from;      ///< address of the peer, or of the client that the proxy states; "socket" of the Unix socket
  bool secure = false;   ///< it came by https
  bool proxied = false;  ///< through a reverse proxy on this computer: hear_proxy()

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

/// Takes the word of a reverse proxy on this computer, a peer from loopback that sends X-Forwarded-For: `from` is the
/// last address in it, the one that the proxy itself saw; `secure` is whether X-Forwarded-Proto is https; X-Forwarded-Host
/// stands for Host.
void hear_proxy(HttpRequest& request);

/// By which a server is reached, beside the names of loopback.
struct HttpNames {
  std::string listens_at{};                   ///< its address; empty: all of this computer
  std::vector<std::string> of_certificate{};  ///< in small letters; "*.museum.example" has one more part before it
  bool any_address = false;                   ///< any address in digits: it listens beyond loopback
};

/// Why a request is refused, whatever its path: a page of another site must not reach this program through the browser.
/// Host has to be one of our names (against DNS rebinding: an address in digits is no name, so nobody can make it lead
/// elsewhere), Origin the requested origin itself, Sec-Fetch-Site the same origin or none. What came through a proxy has
/// the name that the proxy answers to. A body has to be JSON: a browser sends that to another origin only with that
/// origin's permission.
[[nodiscard]] std::optional<HttpResponse> foreign_request(const HttpRequest& request, bool has_body,
                                                          const HttpNames& names = {});

}  // namespace luxrig
