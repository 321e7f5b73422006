#include "tools/luxrigd/api/http_api.h"

#include <fmt/format.h>
#include <unistd.h>

#include <condition_variable>
#include <thread>

#include "tools/http/server.h"
#include "tools/luxrigd/api/access_routes.h"
#include "tools/luxrigd/api/route_table.h"
#include "tools/luxrigd/scheduling.h"
#include "tools/process/meeting_place.h"
#include "tools/process/runtime_folder.h"
#include "tools/process/secret_file.h"

namespace luxrig {
namespace {

constexpr std::chrono::seconds kLookAtFilesEvery{1};

}  // namespace

struct HttpApi::State {
  HttpHandlers handlers;
  std::string web_folder;
  Access access;
  std::string address;
  std::filesystem::path token;
  std::string unreachable;
  DaemonSpec where;
  mutable std::mutex mutex;  // guards the two below
  std::string accounts_problem, tls_problem;
  std::optional<HttpServer> server;
  std::shared_ptr<const Accounts> accounts;            // in use; after start() of `watching` alone, as are the next two
  std::shared_ptr<const TlsIdentity> identity_in_use;  // null: plain
  std::string identity_pem;
  std::jthread watching;

  [[nodiscard]] std::string one_time_address() { return address + "?open=" + access.one_time_code(); }

  /// Answers any client with the page's files. A one-time address makes its browser known.
  HttpResponse page(const HttpRequest& request) {
    if (request.path != "/") return static_file(web_folder, request.path);
    if (const auto code = request.parameter("open")) {
      const auto session = access.open(*code);
      if (!session && request.sender.rank == 0) {
        return {403, "text/plain; charset=utf-8",
                "This address has been used, or is older than ten minutes. luxrig page prints a new one.\n"};
      }
      HttpResponse response{303, "text/plain", {}, {{"Location", "/"}, {"Cache-Control", "no-store"}}};
      if (session) response.headers.emplace_back("Set-Cookie", access.cookie(*session, request.secure));
      return response;
    }
    if (std::error_code none; !std::filesystem::is_directory(web_folder, none)) {
      return {200, "text/plain", "The page was not built (tools/web needs node and npm). GET /api/status works.\n"};
    }
    return static_file(web_folder, "/");
  }

  [[nodiscard]] HttpServerOptions options() {
    HttpServerOptions options;
    add_access_handlers(handlers, access, [this] { return problem(); });
    handlers.one_time_address = [this] { return one_time_address(); };
    options.routes = http_routes(handlers);
    options.page = [this](const HttpRequest& request) { return page(request); };
    options.sender = [this](const HttpRequest& request) { return access.sender(request); };
    options.still = [this](const HttpSender& sender) { return access.still(sender); };
    options.not_for = [this](const HttpSender& sender, const HttpRoute& route) {
      return not_for_sender(sender, route.rank, access.has_accounts());
    };
    options.behind_proxy = where.behind_proxy;
    options.headers = {{"X-Content-Type-Options", "nosniff"},
                       {"X-Frame-Options", "DENY"},
                       {"Referrer-Policy", "no-referrer"},
                       {"Content-Security-Policy",
                        "default-src 'self'; img-src 'self' data:; style-src 'self' 'unsafe-inline'; "
                        "frame-ancestors 'none'"}};
    return options;
  }

  [[nodiscard]] std::string problem() const {
    const std::lock_guard lock(mutex);
    return accounts_problem.empty() || tls_problem.empty() ? accounts_problem + tls_problem
                                                           : accounts_problem + "\n" + tls_problem;
  }

  /// Accounts that cannot be read are nobody's: who wrote them last may have meant to take somebody's away.
  void read_accounts_again() {
    auto read = read_accounts(where.accounts_file);
    Accounts wanted = read ? std::move(*read) : Accounts();
    {
      const std::lock_guard lock(mutex);
      accounts_problem = read ? "" : read.error().front().text();
    }
    if (accounts && accounts->people == wanted.people && accounts->tokens == wanted.tokens) return;
    accounts = std::make_shared<const Accounts>(std::move(wanted));
    access.use(accounts);
  }

  /// A certificate that cannot be read leaves the one before: it is renewed while the daemon runs.
  Result<void> read_identity_again() {
    constexpr std::size_t kMost = 1u << 20;
    auto identity = [&]() -> Checked<std::shared_ptr<const TlsIdentity>> {
      // A group may read the key, as Debian's ssl-cert does.
      auto certificate = read_secret(where.tls_certificate_file, kMost, 0022);
      auto key = read_secret(where.tls_key_file, kMost, 0027);
      if (!certificate) return tl::unexpected(std::move(certificate.error()));
      if (!key) return tl::unexpected(std::move(key.error()));
      const std::string both = *certificate + *key;
      if (identity_in_use && both == identity_pem) return identity_in_use;
      auto made =
          TlsIdentity::make(*certificate, *key, where.tls_certificate_file.string(), where.tls_key_file.string());
      if (made) identity_pem = both;
      return made;
    }();
    {
      const std::lock_guard lock(mutex);
      tls_problem = identity ? "" : identity.error().front().text();
    }
    if (!identity) return refusal(identity.error().front().text());
    if (*identity != identity_in_use) server->use(identity_in_use = *identity);
    return {};
  }

  /// Again and again, on a thread of its own: a slow disk delays nobody.
  void watch_files() {
    watching = std::jthread([this](const std::stop_token& stop) {
      make_background();
      std::mutex asleep;
      std::condition_variable_any end;
      std::unique_lock lock(asleep);
      while (!end.wait_for(lock, stop, kLookAtFilesEvery, [&] { return stop.stop_requested(); })) {
        if (!where.accounts_file.empty()) read_accounts_again();
        if (!where.tls_certificate_file.empty()) (void)read_identity_again();
      }
    });
  }

  /// How a browser on this computer gets there.
  [[nodiscard]] std::string address_of(int port) const {
    std::string host = where.listen == "0.0.0.0" ? "127.0.0.1" : where.listen == "::" ? "::1" : where.listen;
    if (host.find(':') != std::string::npos) host = "[" + host + "]";
    if (!identity_in_use) return fmt::format("http://{}:{}/", host, port);
    for (const std::string& known : identity_in_use->hosts())
      if (known.find('*') == std::string::npos && known.find(':') == std::string::npos)
        return fmt::format("https://{}:{}/", known, port);
    return fmt::format("https://{}:{}/", host, port);
  }
};

HttpApi::HttpApi(HttpHandlers handlers, std::filesystem::path web_folder) : state_(std::make_unique<State>()) {
  state_->handlers = std::move(handlers);
  state_->web_folder = web_folder.string();
}

HttpApi::~HttpApi() { stop(); }

Result<int> HttpApi::start(const DaemonSpec& where) {
  state_->where = where;
  state_->server.emplace(state_->options());
  HttpServer& server = *state_->server;
  if (!where.tls_certificate_file.empty())
    if (const auto read = state_->read_identity_again(); !read) return tl::unexpected(read.error());
  const auto bound = server.bind(where.http_port, where.listen);
  if (!bound) {
    return refusal(
        fmt::format("port {0} of {1} cannot be had: another luxrig has it (stop that, or give --port), or "
                    "this computer does not have the address",
                    where.http_port, where.listen));
  }
  if (!where.accounts_file.empty()) state_->read_accounts_again();
  // The owner of the port also owns the socket and token of that name.
  if (const auto met = meet(*bound); !met) state_->unreachable = met.error().detail;
  state_->access.set_port(*bound);
  state_->address = state_->address_of(*bound);
  if (!where.accounts_file.empty() || !where.tls_certificate_file.empty()) state_->watch_files();
  server.start();
  return *bound;
}

Result<void> HttpApi::meet(int port) {
  const auto folder = runtime_folder();
  if (!folder)
    return refusal(
        "no folder for the daemon's socket that is this user's alone (mode 700): set XDG_RUNTIME_DIR, or remove what "
        "is "
        "in the way of /tmp/luxrig-UID");
  forget_dead_daemons(*folder);
  if (auto made = state_->server->bind_socket(socket_file(*folder, port)); !made) return made;
  state_->token = token_file(*folder, port);
  return write_secret(state_->token, state_->access.token() + "\n");
}

std::string HttpApi::problem() const { return state_->problem(); }

const std::string& HttpApi::unreachable() const { return state_->unreachable; }

std::string HttpApi::one_time_address() { return state_->one_time_address(); }

void HttpApi::stop() {
  state_->watching = {};
  if (state_->server) state_->server->stop();
  if (!state_->token.empty()) ::unlink(state_->token.c_str());
  state_->token.clear();
}

}  // namespace luxrig
