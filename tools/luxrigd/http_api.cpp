#include "tools/luxrigd/http_api.h"

#include <fmt/format.h>
#include <httplib.h>

#include <atomic>
#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

namespace luxrig {
namespace {

constexpr std::size_t kServerThreads = 32;
constexpr int kMostStreams = 16;  // each holds a thread
constexpr auto kStreamPeriod = std::chrono::milliseconds(200);
constexpr double kIdentifyFor_s = 5, kIdentifyAtMost_s = 60;
constexpr double kLongestByHand_s = 366.0 * 86400;
constexpr std::size_t kMostBody = 16u << 20;

/// Host part of "host[:port]" or "http://host[:port]" is this machine's loopback.
bool is_loopback(std::string_view text) {
  if (const auto scheme = text.find("://"); scheme != std::string_view::npos) text.remove_prefix(scheme + 3);
  for (const std::string_view host : {"127.0.0.1", "localhost", "[::1]"}) {
    if (text == host) return true;
    if (text.size() > host.size() && text.substr(0, host.size()) == host && text[host.size()] == ':') return true;
  }
  return false;
}

void refuse(httplib::Response& response, int status, const std::string& what) {
  response.status = status;
  response.set_content(nlohmann::json{{"error", what}}.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace),
                       "application/json");
}

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

}  // namespace

struct HttpApi::State {
  HttpHandlers handlers;
  httplib::Server server;
  std::atomic<bool> running{true};
  std::atomic<int> streams{0};
  std::jthread thread;

  /// A page of another site must not reach the rig through the browser: names other than loopback are refused (DNS
  /// rebinding), and so are posts from another origin.
  httplib::Server::HandlerResponse guard(const httplib::Request& request, httplib::Response& response) {
    using Verdict = httplib::Server::HandlerResponse;
    if (!is_loopback(request.get_header_value("Host"))) {
      refuse(response, 403, "only reachable by its loopback address");
      return Verdict::Handled;
    }
    if (request.method == "POST") {
      if (request.has_header("Origin") && !is_loopback(request.get_header_value("Origin"))) {
        refuse(response, 403, "refused from another origin");
        return Verdict::Handled;
      }
      if (request.get_header_value("Content-Type").rfind("application/json", 0) != 0) {
        refuse(response, 415, "send it with Content-Type: application/json");
        return Verdict::Handled;
      }
    }
    return Verdict::Unhandled;
  }

  /// {"<done>": true, "text": …}, or why not.
  static void answer(httplib::Response& response, const Result<std::string>& done, const char* key) {
    if (!done) {
      const bool theirs = done.error().cause == Cause::invalid || done.error().cause == Cause::refused;
      return refuse(response, theirs ? 400 : 500, done.error().detail);
    }
    const nlohmann::json body = {{key, true}, {"text", *done}};
    response.set_content(body.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace), "application/json");
  }
  static void answer_checked(httplib::Response& response, const Checked<std::string>& done, const char* key) {
    if (done) return answer(response, *done, key);
    std::string text;
    for (const Problem& problem : done.error()) text += (text.empty() ? "" : "\n") + problem.text();
    refuse(response, 400, text);
  }

  void by_hand(const httplib::Request& request, httplib::Response& response, const char* names_key,
               const char* value_key,
               const std::function<Result<std::string>(const std::vector<std::string>&, double, std::optional<double>)>&
                   handler) {
    const auto body = nlohmann::json::parse(request.body, nullptr, false);
    const auto names = names_in(body, names_key);
    const bool timed = body.is_object() && body.contains("for_s");
    if (!names || !body.contains(value_key) || !body[value_key].is_number() ||
        (timed && !(body["for_s"].is_number() && body["for_s"] > 0 && body["for_s"] <= kLongestByHand_s))) {
      return refuse(
          response, 400,
          fmt::format("send {{\"{}\": [\"a name\"], \"{}\": a number}}, and with \"for_s\" above 0 for how long",
                      names_key, value_key));
    }
    answer(response,
           handler(*names, body[value_key].get<double>(),
                   timed ? std::optional(body["for_s"].get<double>()) : std::nullopt),
           "held");
  }

  void stream(httplib::Response& response) {
    if (streams.fetch_add(1) >= kMostStreams) {
      streams.fetch_sub(1);
      refuse(response, 503, "too many pages are open");
      return;
    }
    response.set_header("Cache-Control", "no-store");
    response.set_chunked_content_provider(
        "text/event-stream",
        [this](std::size_t, httplib::DataSink& sink) {
          if (!running) {
            sink.done();
            return true;
          }
          const std::string event = "event: status\ndata: " + handlers.status() + "\n\n";
          if (!sink.write(event.data(), event.size())) return false;
          std::this_thread::sleep_for(kStreamPeriod);
          return true;
        },
        [this](bool) { streams.fetch_sub(1); });
  }

  void routes() {
    server.set_pre_routing_handler([this](const auto& request, auto& response) { return guard(request, response); });
    server.Get("/api/status", [this](const httplib::Request&, httplib::Response& response) {
      response.set_header("Cache-Control", "no-store");
      response.set_content(handlers.status(), "application/json");
    });
    server.Get("/api/universes", [this](const httplib::Request&, httplib::Response& response) {
      response.set_header("Cache-Control", "no-store");
      response.set_content(handlers.universes(), "application/json");
    });
    server.Get("/api/events", [this](const httplib::Request&, httplib::Response& response) { stream(response); });
    server.Get("/api/room", [this](const httplib::Request&, httplib::Response& response) {
      const std::string room = handlers.room_json();
      if (room.empty()) return refuse(response, 503, "the room is being drawn: ask again in a second");
      response.set_content(room, "application/json");
    });
    server.Get("/api/room.png", [this](const httplib::Request&, httplib::Response& response) {
      const std::string png = handlers.room_png();
      if (png.empty()) return refuse(response, 404, "this rig has no scene to draw");
      response.set_content(png, "image/png");
    });
    server.Post("/api/blackout", [this](const httplib::Request& request, httplib::Response& response) {
      const auto body = nlohmann::json::parse(request.body, nullptr, false);
      if (!body.is_object() || !body.contains("on") || !body["on"].is_boolean()) {
        return refuse(response, 400, "send {\"on\": true} or {\"on\": false}");
      }
      const bool on = body["on"].get<bool>();
      if (const auto done = handlers.blackout(on); !done) return refuse(response, 500, done.error().detail);
      response.set_content(nlohmann::json{{"blackout", on}}.dump(), "application/json");
    });
    server.Post("/api/identify", [this](const httplib::Request& request, httplib::Response& response) {
      const auto body = nlohmann::json::parse(request.body, nullptr, false);
      if (!body.is_object() || !body.contains("fixture") || !body["fixture"].is_string() ||
          (body.contains("seconds") && !body["seconds"].is_number())) {
        return refuse(response, 400, "send {\"fixture\": \"its name\", \"seconds\": 5}");
      }
      const double seconds = body.value("seconds", kIdentifyFor_s);
      if (!(seconds > 0 && seconds <= kIdentifyAtMost_s))
        return refuse(response, 400, fmt::format("seconds must be above 0 and at most {:g}", kIdentifyAtMost_s));
      if (const auto done = handlers.identify(body["fixture"].get<std::string>(), seconds); !done)
        return refuse(response, 400, done.error().detail);
      response.set_content(nlohmann::json{{"seconds", seconds}}.dump(), "application/json");
    });
    server.Post("/api/park", [this](const httplib::Request& request, httplib::Response& response) {
      const auto body = nlohmann::json::parse(request.body, nullptr, false);
      std::vector<std::string> fixtures;
      bool good = body.is_object() && (!body.contains("fixtures") || body["fixtures"].is_array());
      if (good && body.contains("fixtures")) {
        for (const auto& one : body["fixtures"]) {
          good = good && one.is_string();
          if (one.is_string()) fixtures.push_back(one.get<std::string>());
        }
      }
      if (!good) return refuse(response, 400, "send {\"fixtures\": [\"a head's name\"]}, or {} for all");
      if (const auto done = handlers.park(fixtures); !done) {
        const bool theirs = done.error().cause == Cause::invalid || done.error().cause == Cause::refused;
        return refuse(response, theirs ? 400 : 500, done.error().detail);
      }
      response.set_content("{\"parked\":true}", "application/json");
    });
    server.Post("/api/hand-back", [this](const httplib::Request&, httplib::Response& response) {
      handlers.hand_back();
      response.set_content("{\"handed_back\":true}", "application/json");
    });
    server.Post("/api/apply", [this](const httplib::Request& request, httplib::Response& response) {
      answer_checked(response, handlers.apply(request.body), "applied");
    });
    server.Post("/api/level", [this](const httplib::Request& request, httplib::Response& response) {
      by_hand(request, response, "fixtures", "level", handlers.level);
    });
    server.Post("/api/goal", [this](const httplib::Request& request, httplib::Response& response) {
      by_hand(request, response, "points", "goal_lux", handlers.goal);
    });
    server.Post("/api/release", [this](const httplib::Request& request, httplib::Response& response) {
      const auto body = nlohmann::json::parse(request.body, nullptr, false);
      const bool all = body.is_object() && body.contains("all") && body["all"] == true;
      const auto names = names_in(body, "names");
      if (all == names.has_value()) {  // "all" must be meant: no list is no reason to release everything
        return refuse(response, 400, "send {\"names\": [\"a fixture or point\"]} or {\"all\": true}");
      }
      answer(response, handlers.release(names.value_or(std::vector<std::string>{})), "released");
    });
    server.Post("/api/bypass", [this](const httplib::Request& request, httplib::Response& response) {
      const auto body = nlohmann::json::parse(request.body, nullptr, false);
      const auto names = names_in(body, "names");
      if (!names || !body.contains("on") || !body["on"].is_boolean())
        return refuse(response, 400, "send {\"names\": [\"a fixture or luxmeter\"], \"on\": true} or false");
      answer(response, handlers.bypass(*names, body["on"].get<bool>()), "done");
    });
    server.Post("/api/reload", [this](const httplib::Request&, httplib::Response& response) {
      answer_checked(response, handlers.reload(), "reloaded");
    });
  }
};

HttpApi::HttpApi(HttpHandlers handlers, std::filesystem::path web_folder) : state_(std::make_unique<State>()) {
  state_->handlers = std::move(handlers);
  auto& server = state_->server;
  server.new_task_queue = [] { return new httplib::ThreadPool(kServerThreads); };
  server.set_payload_max_length(kMostBody);
  server.set_read_timeout(5);
  server.set_write_timeout(5);
  server.set_default_headers({{"X-Content-Type-Options", "nosniff"},
                              {"X-Frame-Options", "DENY"},
                              {"Referrer-Policy", "no-referrer"},
                              {"Content-Security-Policy",
                               "default-src 'self'; img-src 'self' data:; style-src 'self' 'unsafe-inline'; "
                               "frame-ancestors 'none'"}});
  state_->routes();
  if (!server.set_mount_point("/", web_folder.string())) {
    server.Get("/", [](const httplib::Request&, httplib::Response& response) {
      response.set_content("The page was not built (tools/web needs node and npm). GET /api/status works.\n",
                           "text/plain");
    });
  }
}

HttpApi::~HttpApi() { stop(); }

Result<int> HttpApi::start(int port) {
  auto& server = state_->server;
  // Two daemons must not share a port (httplib's default SO_REUSEPORT would let them).
  server.set_socket_options([](socket_t socket) {
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  });
  int bound = port;
  if (port == 0) {
    bound = server.bind_to_any_port("127.0.0.1");
  } else if (!server.bind_to_port("127.0.0.1", port)) {
    bound = -1;
  }
  if (bound <= 0) {
    return tl::unexpected(
        Fault{Cause::system,
              {},
              fmt::format("port {} of 127.0.0.1 is taken, perhaps by another luxrig: stop that, or give --port", port),
              {}});
  }
  state_->thread = std::jthread([this] { state_->server.listen_after_bind(); });
  // stop() does nothing to a server that does not run yet, and it would then run for ever.
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(5);
  while (!server.is_running() && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return bound;
}

void HttpApi::stop() {
  state_->running = false;
  state_->server.stop();
  if (state_->thread.joinable()) state_->thread.join();
}

}  // namespace luxrig
