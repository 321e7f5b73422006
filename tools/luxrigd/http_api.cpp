#include "tools/luxrigd/http_api.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "tools/http/json_body.h"
#include "tools/http/server.h"
#include "tools/luxrigd/access.h"
#include "tools/luxrigd/meeting_place.h"

namespace luxrig {
namespace {

constexpr double kIdentifyFor_s = 5, kIdentifyAtMost_s = 60;
constexpr double kLongestByHand_s = 366.0 * 86400;
constexpr std::size_t kMaxPlanBytes = 16u << 20;

/// A list of texts, not empty.
std::optional<std::vector<std::string>> names_in(const nlohmann::json& body, const char* key) {
  if (!body.is_object() || !body.contains(key) || !body[key].is_array() || body[key].empty()) return std::nullopt;
  std::vector<std::string> names;
  for (const auto& one : body[key]) {
    if (!one.is_string()) return std::nullopt;
    names.push_back(one.get<std::string>());
  }
  return names;
}

HttpResponse json_answer(const nlohmann::json& json) {
  return {200,
          "application/json",
          json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace),
          {{"Cache-Control", "no-store"}}};
}

HttpResponse text_answer(std::string json) {
  return {200, "application/json", std::move(json), {{"Cache-Control", "no-store"}}};
}

HttpResponse fault_answer(const Fault& fault) {
  const bool theirs = fault.cause == Cause::invalid || fault.cause == Cause::refused;
  return http_refusal(theirs ? 400 : 500, fault.detail);
}

/// {"<key>": true, "text": …}, or why not.
HttpResponse done_answer(const Result<std::string>& done, const char* key) {
  if (!done) return fault_answer(done.error());
  return json_answer({{key, true}, {"text", *done}});
}
HttpResponse checked_answer(const Checked<std::string>& done, const char* key) {
  if (done) return done_answer(*done, key);
  std::string text;
  for (const Problem& problem : done.error()) text += (text.empty() ? "" : "\n") + problem.text();
  return http_refusal(400, text);
}

/// A file that only our user can read, whole at any time.
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
  std::optional<HttpServer> server;

  using ByHandHandler =
      std::function<Result<std::string>(const std::vector<std::string>&, double, std::optional<double>)>;
  static HttpResponse by_hand(const HttpRequest& request, const char* names_key, const char* value_key,
                              const ByHandHandler& handler) {
    const auto body = json_body(request.body);
    const auto names = names_in(body, names_key);
    const bool timed = body.is_object() && body.contains("for_s");
    if (!names || !body.contains(value_key) || !body[value_key].is_number() ||
        (timed && !(body["for_s"].is_number() && body["for_s"] > 0 && body["for_s"] <= kLongestByHand_s))) {
      return http_refusal(
          400, fmt::format("send {{\"{}\": [\"a name\"], \"{}\": a number}}, and with \"for_s\" above 0 for how long",
                           names_key, value_key));
    }
    return done_answer(handler(*names, body[value_key].get<double>(),
                               timed ? std::optional(body["for_s"].get<double>()) : std::nullopt),
                       "held");
  }

  [[nodiscard]] HttpResponse blackout(const HttpRequest& request) const {
    const auto body = json_body(request.body);
    if (!body.is_object() || !body.contains("on") || !body["on"].is_boolean())
      return http_refusal(400, "send {\"on\": true} or {\"on\": false}");
    const bool on = body["on"].get<bool>();
    if (const auto done = handlers.blackout(on); !done) return http_refusal(500, done.error().detail);
    return json_answer({{"blackout", on}});
  }

  [[nodiscard]] HttpResponse identify(const HttpRequest& request) const {
    const auto body = json_body(request.body);
    if (!body.is_object() || !body.contains("fixture") || !body["fixture"].is_string() ||
        (body.contains("seconds") && !body["seconds"].is_number()))
      return http_refusal(400, "send {\"fixture\": \"its name\", \"seconds\": 5}");
    const double seconds = body.value("seconds", kIdentifyFor_s);
    if (!(seconds > 0 && seconds <= kIdentifyAtMost_s))
      return http_refusal(400, fmt::format("seconds must be above 0 and at most {:g}", kIdentifyAtMost_s));
    if (const auto done = handlers.identify(body["fixture"].get<std::string>(), seconds); !done)
      return http_refusal(400, done.error().detail);
    return json_answer({{"seconds", seconds}});
  }

  [[nodiscard]] HttpResponse park(const HttpRequest& request) const {
    const auto body = json_body(request.body);
    std::vector<std::string> fixtures;
    bool good = body.is_object() && (!body.contains("fixtures") || body["fixtures"].is_array());
    if (good && body.contains("fixtures")) {
      for (const auto& one : body["fixtures"]) {
        good = good && one.is_string();
        if (one.is_string()) fixtures.push_back(one.get<std::string>());
      }
    }
    if (!good) return http_refusal(400, "send {\"fixtures\": [\"a head's name\"]}, or {} for all");
    if (const auto done = handlers.park(fixtures); !done) return fault_answer(done.error());
    return json_answer({{"parked", true}});
  }

  [[nodiscard]] HttpResponse release(const HttpRequest& request) const {
    const auto body = json_body(request.body);
    const bool all = body.is_object() && body.contains("all") && body["all"] == true;
    const auto names = names_in(body, "names");
    if (all == names.has_value())  // "all" must be meant: no list is no reason to release everything
      return http_refusal(400, "send {\"names\": [\"a fixture or point\"]} or {\"all\": true}");
    return done_answer(handlers.release(names.value_or(std::vector<std::string>{})), "released");
  }

  [[nodiscard]] HttpResponse room_png() const {
    std::string png = handlers.room_png();
    if (png.empty()) return http_refusal(404, "this rig has no scene to draw");
    return {200, "image/png", std::move(png)};
  }

  [[nodiscard]] std::string one_time_address() { return address + "?open=" + access.one_time_code(); }

  /// For everybody: the page's files, and whether the browser is known. A one-time address makes it known.
  HttpResponse page(const HttpRequest& request) {
    const bool known = !access.credential(request).empty();
    if (request.path == "/api/session") return json_answer({{"open", known}});
    if (request.path != "/") return static_file(web_folder, request.path);
    if (const auto code = request.parameter("open")) {
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

  [[nodiscard]] std::vector<HttpRoute> routes() {
    using Request = const HttpRequest&;
    const std::string get = "GET", post = "POST";
    return {
        {get, "/api/status", [this](Request) { return text_answer(handlers.status()); }},
        {get, "/api/universes", [this](Request) { return text_answer(handlers.universes()); }},
        {get, "/api/room", [this](Request) { return text_answer(handlers.room_json()); }},
        {get, "/api/room.png", [this](Request) { return room_png(); }},
        {post, "/api/session",
         [this](Request) {
           return json_answer({{"address", one_time_address()}});
         }},
        {post, "/api/blackout", [this](Request request) { return blackout(request); }, 1024, true},
        {post, "/api/identify", [this](Request request) { return identify(request); }},
        {post, "/api/park", [this](Request request) { return park(request); }},
        {post, "/api/hand-back",
         [this](Request) {
           handlers.hand_back();
           return json_answer({{"handed_back", true}});
         }},
        {post, "/api/apply",
         [this](Request request) { return checked_answer(handlers.apply(request.body), "applied"); }, kMaxPlanBytes},
        {post, "/api/level", [this](Request request) { return by_hand(request, "fixtures", "level", handlers.level); }},
        {post, "/api/goal", [this](Request request) { return by_hand(request, "points", "goal_lux", handlers.goal); }},
        {post, "/api/release", [this](Request request) { return release(request); }},
        {post, "/api/reload", [this](Request) { return checked_answer(handlers.reload(), "reloaded"); }},
    };
  }

  [[nodiscard]] HttpServerOptions options() {
    HttpServerOptions options;
    options.routes = routes();
    options.page = [this](const HttpRequest& request) { return page(request); };
    options.events_path = "/api/events";
    options.event = [this] { return "event: status\ndata: " + handlers.status() + "\n\n"; };
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
  // Whoever has the port has the socket and the token of that name.
  const auto folder = make_meeting_folder();
  if (!folder) return tl::unexpected(folder.error());
  if (const auto made = server.bind_socket(socket_file(*folder, *bound)); !made) return tl::unexpected(made.error());
  state_->token = token_file(*folder, *bound);
  if (const auto left = write_secret(state_->token, state_->access.token() + "\n"); !left)
    return tl::unexpected(left.error());
  state_->access.set_port(*bound);
  state_->address = fmt::format("http://127.0.0.1:{}/", *bound);
  server.start();
  return *bound;
}

std::string HttpApi::one_time_address() { return state_->one_time_address(); }

void HttpApi::stop() {
  state_->server->stop();
  if (!state_->token.empty()) ::unlink(state_->token.c_str());
  state_->token.clear();
}

}  // namespace luxrig
