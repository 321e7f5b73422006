#pragma once
/// A small HTTP/1.1 server, plain or within TLS, that hostile neighbours cannot stop. Everything has limits and deadlines, and
/// urgent requests wait for nothing. README.md beside this file has the details.

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "tools/http/message.h"
#include "tools/http/tls_identity.h"

namespace luxrig {

struct HttpRoute {
  std::string method, path;  ///< path: as path_is_of() reads it
  /// Called on threads of the server.
  std::function<HttpResponse(const HttpRequest&)> handle;
  std::size_t max_body_bytes = 16u << 10;
  bool urgent = false;  ///< runs on a thread of its own, at normal priority
  int rank = 1;         ///< least rank of its senders; 0: for unknown ones, too
  /// A stream of server-sent events, for GET: what `handle` answers to an empty request is one whole event,
  /// `event: …\ndata: …\n\n`, for all readers, five a second. One route at most.
  bool events = false;
  /// Takes long on the processor: these run one after the other, on a thread of their own, and a few at most wait.
  bool slow = false;
};

struct HttpServerOptions {
  std::vector<HttpRoute> routes;
  /// Answers every GET without a route, for all senders. Empty: 404.
  std::function<HttpResponse(const HttpRequest&)> page{};
  /// The sender of a request, from its headers: of rank 0 if it is unknown. Called on the server's wire thread, so it
  /// must be quick. Without this function everything is allowed to all senders. Not called for the Unix socket, whose
  /// peers may do all.
  std::function<HttpSender(const HttpRequest&)> sender{};
  /// Whether that sender still has its access: asked before each event of a stream. Empty: it has.
  std::function<bool(const HttpSender&)> still{};
  /// The answer to a sender whose rank is too low for the route. Empty: a default text.
  std::function<HttpResponse(const HttpSender&, const HttpRoute&)> not_for{};
  /// The answer to a request for an unknown path. Empty: a default text.
  std::function<std::string(const std::string& path)> no_route{};
  bool behind_proxy = false;  ///< hear_proxy()
  HttpHeaders headers{};      ///< sent with every answer
};

class HttpServer {
 public:
  explicit HttpServer(HttpServerOptions options);
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  /// Binds the port (0 = any) of an address of this computer and returns the port; nothing if it is taken, or is not
  /// ours to take. Connections wait until start(). Beyond loopback, call use() before start().
  [[nodiscard]] std::optional<int> bind(int port, const std::string& address = "127.0.0.1");
  /// New connections to the port have to speak TLS, with this identity. Those of the Unix socket never do.
  void use(std::shared_ptr<const TlsIdentity> identity);
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
