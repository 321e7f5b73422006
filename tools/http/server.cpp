#include "tools/http/server.h"

#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <limits>
#include <thread>

#include "core/check.h"
#include "tools/http/lane.h"
#include "tools/http/request_reader.h"
#include "tools/http/wire_stream.h"

namespace luxrig {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;
using Socket = WireStream::Socket;
using SteadyClock = std::chrono::steady_clock;
using Instant = SteadyClock::time_point;
using std::chrono::milliseconds;

constexpr std::size_t kMaxConnections = 64;  // of TCP, and as many again of the Unix socket
constexpr std::size_t kMaxStreams = 16, kMaxStreamsOfOne = 8;
constexpr std::size_t kLargeBodyBytes = 64u << 10;
constexpr int kMaxLargeBodies = 2;  // at once: bodies are held in memory whole
constexpr int kMaxSlow = 4;
constexpr int kAllRanks = std::numeric_limits<int>::max();
constexpr milliseconds kIdle{15000}, kHead{5000}, kBody{10000}, kLargeBody{30000}, kAnswer{5000}, kDrain{1000};
constexpr milliseconds kTick{100};
constexpr int kTicksPerEvent = 2;
constexpr int kNotModified = 304;

const char* phrase_of(int status) {
  switch (status) {
    case 200:
      return "OK";
    case 303:
      return "See Other";
    case kNotModified:
      return "Not Modified";
    case 400:
      return "Bad Request";
    case 401:
      return "Unauthorized";
    case 403:
      return "Forbidden";
    case 404:
      return "Not Found";
    case 405:
      return "Method Not Allowed";
    case 409:
      return "Conflict";
    case 412:
      return "Precondition Failed";
    case 413:
      return "Content Too Large";
    case 415:
      return "Unsupported Media Type";
    case 429:
      return "Too Many Requests";
    case 431:
      return "Request Header Fields Too Large";
    case 503:
      return "Service Unavailable";
    default:
      return status < 500 ? "Refused" : "Failed";
  }
}

HttpResponse called(const std::function<HttpResponse(const HttpRequest&)>& handler, const HttpRequest& request) {
  try {
    return handler(request);
  } catch (const std::exception& error) {  // a request must not end a program that drives lamps
    return http_refusal(500, error.what());
  }
}

/// The peer is root, or the user of this process.
bool is_ours(Socket& socket) {
  ucred peer{};
  socklen_t length = sizeof peer;
  return ::getsockopt(socket.native_handle(), SOL_SOCKET, SO_PEERCRED, &peer, &length) == 0 &&
         (peer.uid == 0 || peer.uid == ::geteuid());
}

/// Of the peer; empty if it has gone. An IPv4 address in the form of IPv6 is the IPv4 address.
std::string address_of(const asio::ip::tcp::socket& socket) {
  error_code gone;
  auto address = socket.remote_endpoint(gone).address();
  if (gone) return "";
  if (address.is_v6() && address.to_v6().is_v4_mapped())
    address = asio::ip::make_address_v4(asio::ip::v4_mapped, address.to_v6());
  return address.to_string();
}
std::string address_of(const asio::local::stream_protocol::socket&) { return ""; }

}  // namespace

struct HttpServer::State {
  class Connection;

  explicit State(HttpServerOptions given) : options(std::move(given)) {
    for (const auto& [name, value] : options.headers) headers += name + ": " + value + "\r\n";
    for (const HttpRoute& route : options.routes)
      if (route.events) events = &route;
  }

  template <class Acceptor>
  void accept(Acceptor& acceptor, bool trusted);
  void admit(Socket socket, bool trusted, std::string from);
  void remove(const std::shared_ptr<Connection>& connection);
  void tick();
  void tell_streams();
  [[nodiscard]] bool stream_is_free(const std::string& credential) const;

  HttpServerOptions options;
  HttpNames names;                         // by which it is reached
  std::shared_ptr<const TlsIdentity> tls;  // of new connections by TCP; null: they are plain
  const HttpRoute* events = nullptr;  // null if no route is a stream
  std::string headers;
  asio::io_context io{1};  // one thread uses everything below, except the lanes
  asio::ip::tcp::acceptor tcp{io};
  asio::local::stream_protocol::acceptor local{io};
  std::string socket_file;
  asio::steady_timer timer{io};
  std::vector<std::shared_ptr<Connection>> connections;
  int large_bodies = 0, slow_ones = 0;
  int ticks = 0;
  bool ticking = false, event_wanted = false;

  Lane urgent{1, false}, looking{2, true}, changing{2, true}, slow{1, true};
  std::thread thread;
};

/// One peer: a request, its answer, the next request.
class HttpServer::State::Connection : public std::enable_shared_from_this<Connection> {
 public:
  enum class Doing { waits, reads_body, is_handled, answers, drains, streams };

  Connection(State& server, Socket socket, bool trusted, std::string from)
      : server_(server),
        stream_(std::move(socket), trusted ? nullptr : server.tls),
        trusted_(trusted),
        from_(std::move(from)) {}

  [[nodiscard]] Doing doing() const { return doing_; }
  [[nodiscard]] bool trusted() const { return trusted_; }
  [[nodiscard]] Instant since() const { return since_; }
  [[nodiscard]] const HttpSender& sender() const { return sender_; }
  /// No request of its own is being handled; it may be closed in favour of a new connection.
  [[nodiscard]] bool has_nothing() const {
    return doing_ == Doing::waits || doing_ == Doing::reads_body || doing_ == Doing::drains;
  }

  void begin() {
    since_ = SteadyClock::now();
    deadline_ = since_ + kHead;
    stream_.begin([self = this->shared_from_this()](error_code error) {
      if (self->closed_) return;
      if (!error) return self->await_request();
      if (!self->stream_.peer_speaks_plain_http(error)) return self->close();
      self->answer(http_refusal(400, "this port speaks https: begin the address with https://"), true);
    });
  }

  void await_request() {
    reader_ = std::make_unique<RequestReader>();
    head_only_ = false;
    doing_ = Doing::waits;
    since_ = SteadyClock::now();
    deadline_ = since_ + kIdle;
    read();
  }

  void check(Instant now) {
    if (deadline_ && now > *deadline_) close();
  }

  void close() {
    if (closed_) return;
    closed_ = true;
    free_body();
    stream_.close();
    server_.remove(shared_from_this());
  }

  void send_event(const std::shared_ptr<const std::string>& text) {
    if (closed_ || writing_) return;  // a slow reader misses some events
    // Not again for the Unix socket, which never asked.
    if (!trusted_ && server_.options.still && !server_.options.still(sender_)) return close();
    write(text, [](Connection& self) { self.deadline_.reset(); });
  }

 private:
  void read() {
    stream_.read_some(asio::buffer(buffer_), [self = this->shared_from_this()](error_code error, std::size_t n) {
      if (self->closed_) return;
      if (error) return self->close();
      self->take({self->buffer_.data(), n});
    });
  }

  void take(std::string_view bytes) {
    if (!reader_->begun()) deadline_ = SteadyClock::now() + kHead;
    reader_->put(bytes);
    if (reader_->at() == RequestReader::At::decision) {
      if (const auto refusal = decide()) return answer(*refusal, true);
      if (reader_->at() == RequestReader::At::body && reader_->request().header("expect")) {
        return write(
            std::make_shared<const std::string>("HTTP/1.1 100 Continue\r\n\r\n"), [](Connection& self) { self.read(); },
            false);
      }
    }
    switch (reader_->at()) {
      case RequestReader::At::refused:
        return answer(reader_->refusal(), true);
      case RequestReader::At::whole:
        return handle();
      default:
        read();
    }
  }

  /// Every check that is possible before the body is read.
  std::optional<HttpResponse> decide() {
    HttpRequest& request = reader_->request();
    request.from = from_;
    request.secure = stream_.secure();
    if (server_.options.behind_proxy) hear_proxy(request);
    if (auto refusal = foreign_request(request, reader_->has_body(), server_.names)) return refusal;
    head_only_ = request.method == "HEAD";
    const std::string method = head_only_ ? "GET" : request.method;
    const HttpServerOptions& options = server_.options;
    bool known_path = false;
    route_ = nullptr;
    for (const HttpRoute& route : options.routes) {
      const bool here = path_is_of(request.path, route.path);
      known_path = known_path || here;
      // A stream has no length that HEAD could tell.
      if (here && route.method == (route.events ? request.method : method)) route_ = &route;
    }
    events_ = route_ && route_->events;
    const bool page = !known_path && method == "GET" && options.page;
    if (!route_ && !page) {
      return known_path ? http_refusal(405, "this route is not for " + request.method.substr(0, 16))
                        : http_refusal(404, options.no_route ? options.no_route(request.path)
                                                             : "there is no route " + request.path);
    }
    sender_ = trusted_         ? HttpSender{"socket", "", kAllRanks}
              : options.sender ? options.sender(request)
                               : HttpSender{"anybody", "", kAllRanks};
    if (!page && sender_.rank < route_->rank) {
      return options.not_for ? options.not_for(sender_, *route_)
                             : http_refusal(sender_.credential.empty() ? 401 : 403, "not allowed");
    }
    if (events_ && !server_.stream_is_free(sender_.credential)) return http_refusal(503, "too many pages are open");
    const std::size_t most = route_ ? route_->max_body_bytes : 0;
    const bool large = std::min<std::uint64_t>(most, reader_->longest_body_bytes()) > kLargeBodyBytes;
    if (large && server_.large_bodies >= kMaxLargeBodies)
      return http_refusal(503, "others are sending files just now: try again");
    reader_->accept_body(most);
    if (reader_->at() == RequestReader::At::refused) return reader_->refusal();
    if (reader_->at() == RequestReader::At::body) {
      doing_ = Doing::reads_body;
      deadline_ = SteadyClock::now() + (large ? kLargeBody : kBody);
    }
    if (large) {
      has_large_body_ = true;
      ++server_.large_bodies;
    }
    return std::nullopt;
  }

  void free_body() {
    if (has_large_body_) --server_.large_bodies;
    has_large_body_ = false;
  }

  void handle() {
    keep_alive_ = reader_->keep_alive() && !reader_->more_came();
    if (events_) return stream();
    doing_ = Doing::is_handled;
    deadline_.reset();
    const auto& handler = route_ ? route_->handle : server_.options.page;
    auto request = std::make_shared<HttpRequest>(reader_->take());
    request->sender = sender_;
    reader_.reset();
    const bool is_slow = route_ && route_->slow;
    if (is_slow && server_.slow_ones >= kMaxSlow)
      return answer(http_refusal(503, "others ask for it just now: try again"), true);
    if (is_slow) ++server_.slow_ones;
    Lane& lane = route_ && route_->urgent                 ? server_.urgent
                 : is_slow                                ? server_.slow
                 : request->method == "GET" || head_only_ ? server_.looking
                                                          : server_.changing;
    lane.push([self = this->shared_from_this(), &handler, request, is_slow]() mutable {
      const auto response = std::make_shared<HttpResponse>(called(handler, *request));
      request.reset();
      asio::post(self->server_.io, [self, response, is_slow] {
        if (is_slow) --self->server_.slow_ones;
        self->free_body();
        if (!self->closed_) self->answer(*response, !self->keep_alive_);
      });
    });
  }

  void answer(const HttpResponse& response, bool last) {
    doing_ = Doing::answers;
    free_body();
    std::string text = fmt::format("HTTP/1.1 {} {}\r\n{}Connection: {}\r\n", response.status,
                                   phrase_of(response.status), server_.headers, last ? "close" : "keep-alive");
    // 304 has no body, and a length would be that of the body which the peer has.
    if (response.status != kNotModified)
      text += fmt::format("Content-Type: {}\r\nContent-Length: {}\r\n", response.content_type, response.body.size());
    for (const auto& [name, value] : response.headers) text += name + ": " + value + "\r\n";
    text += "\r\n";
    if (!head_only_) text += response.body;
    write(std::make_shared<const std::string>(std::move(text)),
          [last](Connection& self) { last ? self.drain() : self.await_request(); });
  }

  /// The peer may still be sending an unwanted body. Closing at once would lose the answer.
  void drain() {
    doing_ = Doing::drains;
    since_ = SteadyClock::now();
    deadline_ = since_ + kDrain;
    reader_.reset();
    stream_.end([self = this->shared_from_this()](error_code error) {
      if (!self->closed_) error ? self->close() : self->read_to_end();
    });
  }

  void read_to_end() {
    stream_.read_raw(asio::buffer(buffer_), [self = this->shared_from_this()](error_code error, std::size_t) {
      if (!self->closed_) error ? self->close() : self->read_to_end();
    });
  }

  void stream() {
    doing_ = Doing::streams;
    server_.event_wanted = true;
    write(std::make_shared<const std::string>(fmt::format("HTTP/1.1 200 OK\r\n{}Content-Type: text/event-stream\r\n"
                                                          "Cache-Control: no-store\r\nConnection: close\r\n\r\n",
                                                          server_.headers)),
          [](Connection& self) {
            self.deadline_.reset();
            self.server_.tell_streams();
          });
  }

  template <class Then>
  void write(std::shared_ptr<const std::string> text, Then then, bool timed = true) {
    if (timed) deadline_ = SteadyClock::now() + kAnswer;
    writing_ = true;
    stream_.write(asio::buffer(*text), [self = this->shared_from_this(), text, then](error_code error, std::size_t) {
      self->writing_ = false;
      if (self->closed_) return;
      if (error) return self->close();
      then(*self);
    });
  }

  State& server_;
  WireStream stream_;
  const bool trusted_;
  const std::string from_;
  Doing doing_ = Doing::waits;
  Instant since_{};  // start of the wait for a request, or for the end
  std::optional<Instant> deadline_;
  std::unique_ptr<RequestReader> reader_;
  const HttpRoute* route_ = nullptr;
  HttpSender sender_;
  bool events_ = false, head_only_ = false, keep_alive_ = false, has_large_body_ = false, writing_ = false, closed_ = false;
  std::array<char, 16384> buffer_;
};

template <class Acceptor>
void HttpServer::State::accept(Acceptor& acceptor, bool trusted) {
  acceptor.async_accept([this, &acceptor, trusted](error_code error, auto socket) {
    if (error == asio::error::operation_aborted) return;
    if (error) {  // out of file descriptors: wait until some are closed
      const auto later = std::make_shared<asio::steady_timer>(io, kTick);
      later->async_wait([this, &acceptor, trusted, later](error_code) { accept(acceptor, trusted); });
      return;
    }
    std::string from = trusted ? "socket" : address_of(socket);
    admit(Socket(std::move(socket)), trusted, std::move(from));
    accept(acceptor, trusted);
  });
}

void HttpServer::State::admit(Socket socket, bool trusted, std::string from) {
  if (trusted && !is_ours(socket)) return;
  std::size_t count = 0;
  std::shared_ptr<Connection> idlest;
  for (const auto& connection : connections) {
    if (connection->trusted() != trusted) continue;
    ++count;
    if (connection->has_nothing() && (!idlest || connection->since() < idlest->since())) idlest = connection;
  }
  if (count >= kMaxConnections) {
    if (!idlest) return;
    idlest->close();
  }
  connections.push_back(std::make_shared<Connection>(*this, std::move(socket), trusted, std::move(from)));
  connections.back()->begin();
  if (!ticking) tick();
}

void HttpServer::State::remove(const std::shared_ptr<Connection>& connection) {
  connections.erase(std::remove(connections.begin(), connections.end(), connection), connections.end());
}

void HttpServer::State::tick() {
  ticking = !connections.empty();
  if (!ticking) return;
  const auto copy = connections;  // close() removes the connection
  for (const auto& connection : copy) connection->check(SteadyClock::now());
  if (++ticks % kTicksPerEvent == 0) event_wanted = true;
  tell_streams();
  timer.expires_after(kTick);
  timer.async_wait([this](error_code error) {
    if (!error) tick();
  });
}

void HttpServer::State::tell_streams() {
  const auto is_stream = [](const auto& one) { return one->doing() == Connection::Doing::streams; };
  if (!event_wanted || std::none_of(connections.begin(), connections.end(), is_stream)) return;
  event_wanted = false;
  looking.push([this, is_stream] {
    const auto text = std::make_shared<const std::string>(called(events->handle, {}).body);
    asio::post(io, [this, is_stream, text] {
      const auto copy = connections;
      for (const auto& connection : copy)
        if (is_stream(connection)) connection->send_event(text);
    });
  });
}

bool HttpServer::State::stream_is_free(const std::string& credential) const {
  std::size_t all = 0, of_this = 0;
  for (const auto& connection : connections) {
    if (connection->doing() != Connection::Doing::streams) continue;
    ++all;
    if (connection->sender().credential == credential) ++of_this;
  }
  return all < kMaxStreams && of_this < kMaxStreamsOfOne;
}

HttpServer::HttpServer(HttpServerOptions options) : state_(std::make_unique<State>(std::move(options))) {}
HttpServer::~HttpServer() { stop(); }

std::optional<int> HttpServer::bind(int port, const std::string& address) {
  auto& acceptor = state_->tcp;
  error_code error;
  const auto where = asio::ip::make_address(address, error);
  if (error) return std::nullopt;
  state_->names.listens_at = where.is_unspecified() ? "" : where.to_string();
  state_->names.any_address = !where.is_loopback();
  const asio::ip::tcp::endpoint endpoint(where, static_cast<unsigned short>(port));
  acceptor.open(endpoint.protocol(), error);
  // Not SO_REUSEPORT: two servers must not share a port.
  if (!error) acceptor.set_option(asio::socket_base::reuse_address(true), error);
  if (!error) acceptor.bind(endpoint, error);
  if (!error) acceptor.listen(asio::socket_base::max_listen_connections, error);
  if (error) {
    error_code ignored;
    acceptor.close(ignored);
    return std::nullopt;
  }
  return acceptor.local_endpoint().port();
}

Result<void> HttpServer::bind_socket(const std::string& file) {
  auto& acceptor = state_->local;
  const auto fault = [&](const std::string& why) {
    return tl::unexpected(Fault{Cause::system, {}, fmt::format("socket {}: {}", file, why), {}});
  };
  error_code error;
  acceptor.open(asio::local::stream_protocol(), error);
  if (error) return fault(error.message());
  if (file.size() >= sizeof(sockaddr_un::sun_path)) return fault("its path is too long for a socket");
  ::unlink(file.c_str());
  acceptor.bind(asio::local::stream_protocol::endpoint(file), error);
  if (error) return fault(error.message());
  // No peer can connect before listen().
  if (::chmod(file.c_str(), S_IRUSR | S_IWUSR) != 0) return fault("its mode cannot be set to 600");
  acceptor.listen(asio::socket_base::max_listen_connections, error);
  if (error) return fault(error.message());
  state_->socket_file = file;
  return {};
}

void HttpServer::use(std::shared_ptr<const TlsIdentity> identity) {
  const auto take = [state = state_.get(), identity = std::move(identity)] {
    state->names.of_certificate = identity->hosts();
    state->tls = identity;
  };
  state_->thread.joinable() ? asio::post(state_->io, take) : take();
}

void HttpServer::start() {
  LUXRIG_CHECK(!state_->names.any_address || state_->tls, "beyond loopback without TLS");
  state_->thread = std::thread([state = state_.get()] {
    lower_priority();
    if (state->tcp.is_open()) state->accept(state->tcp, false);
    if (state->local.is_open()) state->accept(state->local, true);
    const auto forever = asio::make_work_guard(state->io);
    state->io.run();
  });
}

void HttpServer::stop() {
  State& state = *state_;
  if (state.thread.joinable()) {
    asio::post(state.io, [&state] {
      error_code ignored;
      state.tcp.close(ignored);
      state.local.close(ignored);
      const auto copy = state.connections;
      for (const auto& connection : copy) connection->close();
      state.io.stop();
    });
    state.thread.join();
  }
  for (Lane* lane : {&state.urgent, &state.looking, &state.changing, &state.slow}) lane->stop();
  if (!state.socket_file.empty()) ::unlink(state.socket_file.c_str());
  state.socket_file.clear();
}

}  // namespace luxrig
