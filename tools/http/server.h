#pragma once
/// A small HTTP/1.1 server for loopback that hostile neighbours cannot stop: limits and deadlines everywhere, and what
/// is urgent waits for nobody. README.md beside this file says how.

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
  std::string method, path;
  /// Called on threads of the server.
  std::function<HttpResponse(const HttpRequest&)> handle;
  std::size_t max_body_bytes = 16u << 10;
  bool urgent = false;  ///< has a thread of its own, at normal priority
};

struct HttpServerOptions {
  std::vector<HttpRoute> routes;
  /// Answers every GET that has no route, for everybody. Empty: 404.
  std::function<HttpResponse(const HttpRequest&)> page{};
  /// GET of this path is a stream of server-sent events, each a whole `event: …\ndata: …\n\n`, five a second.
  std::string events_path{};
  std::function<std::string()> event{};
  /// Who asks, by the request's headers; empty: nobody known, whom only `page` answers. Called on the server's thread
  /// for the wire, so it must be quick. No function: everybody may everything. Who comes through the Unix socket is not
  /// asked.
  std::function<std::string(const HttpRequest&)> credential{};
  /// What somebody is told who asks for a path that there is not. Empty: that.
  std::function<std::string(const std::string& path)> no_route{};
  std::string no_credential = "not allowed";  ///< what such a one is told
  HttpHeaders headers{};                      ///< of every answer
};

class HttpServer {
 public:
  explicit HttpServer(HttpServerOptions options);
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  /// Binds 127.0.0.1:port (0 = any) and returns the port; nothing when it is taken. Connections wait until start().
  [[nodiscard]] std::optional<int> bind(int port);
  /// Binds a Unix socket, mode 600, for root and our own user. A file of that name is replaced. Before start().
  [[nodiscard]] Result<void> bind_socket(const std::string& file);
  void start();
  /// Closes every connection; returns when no handler runs any more.
  void stop();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace luxrig
