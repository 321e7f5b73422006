#pragma once
/// A small HTTP/1.1 server for loopback that hostile neighbours cannot stop. Everything has limits and deadlines, and
/// urgent requests wait for nothing. README.md beside this file has the details.

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "tools/http/message.h"

namespace luxrig {

struct HttpRoute {
  std::string method, path;  ///< path: as path_is_of() reads it
  /// Called on threads of the server.
  std::function<HttpResponse(const HttpRequest&)> handle;
  std::size_t max_body_bytes = 16u << 10;
  bool urgent = false;       ///< runs on a thread of its own, at normal priority
  bool for_anybody = false;  ///< for unknown senders, too
  /// A stream of server-sent events, for GET: what `handle` answers to an empty request is one whole event,
  /// `event: …\ndata: …\n\n`, for all readers, five a second. One route at most.
  bool events = false;
};

struct HttpServerOptions {
  std::vector<HttpRoute> routes;
  /// Answers every GET without a route, for all senders. Empty: 404.
  std::function<HttpResponse(const HttpRequest&)> page{};
  /// The sender of a request, from its headers. Empty = unknown: only `page` and routes for anybody answer
  /// then. Called on the server's wire
  /// thread, so it must be quick. Without this function everything is allowed to all senders. Not called for the Unix
  /// socket, whose peers are trusted.
  std::function<std::string(const HttpRequest&)> credential{};
  /// The answer to a request for an unknown path. Empty: a default text.
  std::function<std::string(const std::string& path)> no_route{};
  std::string no_credential = "not allowed";  ///< the answer to an unknown sender
  HttpHeaders headers{};                      ///< sent with every answer
};

class HttpServer {
 public:
  explicit HttpServer(HttpServerOptions options);
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  /// Binds 127.0.0.1:port (0 = any) and returns the port; nothing if it is taken. Connections wait until start().
  [[nodiscard]] std::optional<int> bind(int port);
  /// Binds a Unix socket, mode 600, for root and our own user. Replaces a file of that name. Call before start().
  [[nodiscard]] Result<void> bind_socket(const std::string& file);
  void start();
  /// Closes every connection. Returns when no handler runs any more.
  void stop();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace luxrig
