#include "tools/luxrigd/api/http_api.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "tools/http/server.h"
#include "tools/luxrigd/api/access.h"
#include "tools/luxrigd/api/route_table.h"
#include "tools/process/meeting_place.h"
#include "tools/process/runtime_folder.h"

namespace luxrig {
namespace {

/// Writes a file that only our user can read and that is whole at any time.
Result<void> write_secret(const std::filesystem::path& file, const std::string& text) {
  const std::string aside = file.string() + ".new";
  ::unlink(aside.c_str());
  const int to = ::open(aside.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  const bool written = to >= 0 && ::write(to, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  if (to >= 0) ::close(to);
  if (written && ::rename(aside.c_str(), file.c_str()) == 0) return {};
  return tl::unexpected(Fault{Cause::system, {}, fmt::format("{} cannot be written", file.string()), {}});
}

}  // namespace

struct HttpApi::State {
  HttpHandlers handlers;
  std::string web_folder;
  Access access;
  std::string address;
  std::filesystem::path token;
  std::string unreachable;
  std::optional<HttpServer> server;

  [[nodiscard]] std::string one_time_address() { return address + "?open=" + access.one_time_code(); }

  /// Answers any client with the page's files. A one-time address makes its browser known.
  HttpResponse page(const HttpRequest& request) {
    if (request.path != "/") return static_file(web_folder, request.path);
    if (const auto code = request.parameter("open")) {
      const bool known = !access.credential(request).empty();
      const auto session = access.open(*code);
      if (!session && !known) {
        return {403, "text/plain; charset=utf-8",
                "This address has been used, or is older than ten minutes. luxrig page prints a new one.\n"};
      }
      HttpResponse response{303, "text/plain", {}, {{"Location", "/"}, {"Cache-Control", "no-store"}}};
      if (session) response.headers.emplace_back("Set-Cookie", access.cookie(*session));
      return response;
    }
    if (std::error_code none; !std::filesystem::is_directory(web_folder, none)) {
      return {200, "text/plain", "The page was not built (tools/web needs node and npm). GET /api/status works.\n"};
    }
    return static_file(web_folder, "/");
  }

  [[nodiscard]] HttpServerOptions options() {
    HttpServerOptions options;
    handlers.knows = [this](const HttpRequest& request) {
      return !request.credential.empty() || !access.credential(request).empty();
    };
    handlers.one_time_address = [this] { return one_time_address(); };
    options.routes = http_routes(handlers);
    options.page = [this](const HttpRequest& request) { return page(request); };
    options.credential = [this](const HttpRequest& request) { return access.credential(request); };
    options.no_credential =
        "the daemon does not know who asks: open its page with the address that luxrig page prints; a program sends "
        "Authorization: Bearer and the daemon's token";
    options.headers = {{"X-Content-Type-Options", "nosniff"},
                       {"X-Frame-Options", "DENY"},
                       {"Referrer-Policy", "no-referrer"},
                       {"Content-Security-Policy",
                        "default-src 'self'; img-src 'self' data:; style-src 'self' 'unsafe-inline'; "
                        "frame-ancestors 'none'"}};
    return options;
  }
};

HttpApi::HttpApi(HttpHandlers handlers, std::filesystem::path web_folder) : state_(std::make_unique<State>()) {
  state_->handlers = std::move(handlers);
  state_->web_folder = web_folder.string();
  state_->server.emplace(state_->options());
}

HttpApi::~HttpApi() { stop(); }

Result<int> HttpApi::start(int port) {
  HttpServer& server = *state_->server;
  const auto bound = server.bind(port);
  if (!bound) {
    return tl::unexpected(
        Fault{Cause::system,
              {},
              fmt::format("port {} of 127.0.0.1 is taken, perhaps by another luxrig: stop that, or give --port", port),
              {}});
  }
  // The owner of the port also owns the socket and token of that name.
  if (const auto met = meet(*bound); !met) state_->unreachable = met.error().detail;
  state_->access.set_port(*bound);
  state_->address = fmt::format("http://127.0.0.1:{}/", *bound);
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

const std::string& HttpApi::unreachable() const { return state_->unreachable; }

std::string HttpApi::one_time_address() { return state_->one_time_address(); }

void HttpApi::stop() {
  state_->server->stop();
  if (!state_->token.empty()) ::unlink(state_->token.c_str());
  state_->token.clear();
}

}  // namespace luxrig
