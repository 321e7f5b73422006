#include "tools/luxrig-sim/control_http.h"

#include <httplib.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>
#include <vector>

#include "core/rig/nearest.h"

namespace luxrig::sim {
namespace {

constexpr const char* kLoopback = "127.0.0.1";
constexpr std::chrono::seconds kMostWait{5};  // until the control port listens
constexpr const char* kJson = "application/json";
constexpr std::string_view kRoutes[] = {"/truth", "/picture", "/fault", "/clear_faults", "/reset_peaks"};

void answer(httplib::Response& response, int status, const nlohmann::json& json) {
  response.status = status;
  response.set_content(json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace), kJson);
}

class Server final : public ControlHttp {
 public:
  Server(const Rig& rig, World& world, Faults& faults, std::mutex& world_mutex, std::uint64_t seed)
      : rig_(rig), world_(world), faults_(faults), world_mutex_(world_mutex), cameras_(rig, world, world_mutex, seed) {
    server_.new_task_queue = [] { return new httplib::ThreadPool(4); };  // httplib deletes it
    server_.set_payload_max_length(65536);
    // Not SO_REUSEPORT, the library's own choice: with it a second simulator would silently share the port.
    server_.set_socket_options([](socket_t socket) {
      const int yes = 1;
      ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
    server_.Get("/truth", [this](const httplib::Request&, httplib::Response& response) {
      const std::lock_guard lock(world_mutex_);
      response.set_content(truth_json(rig_, world_), kJson);
    });
    server_.Get("/picture", [this](const httplib::Request& request, httplib::Response& response) {
      take_picture(request.get_param_value("camera"), response);
    });
    for (const char* route : {"/fault", "/clear_faults", "/reset_peaks"}) {
      server_.Post(route, [this](const httplib::Request& request, httplib::Response& response) {
        obey(request.path, request.body, response);
      });
    }
    // `curl -X POST` states no length, and the library would wait for a body until it gives up.
    server_.set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
      if (request.method != "POST" || request.has_header("Content-Length") || request.has_header("Transfer-Encoding"))
        return httplib::Server::HandlerResponse::Unhandled;
      obey(request.path, "", response);
      return httplib::Server::HandlerResponse::Handled;
    });
    server_.set_error_handler([](const httplib::Request& request, httplib::Response& response) {
      if (!response.body.empty()) return;
      if (response.status == 404) return no_route(request.path, response);
      answer(response, response.status, {{"error", "not understood: see luxrig-sim's README for the routes"}});
    });
  }

  ~Server() override {
    if (!thread_.joinable()) return;
    // stop() before the thread listens would be lost.
    while (!server_.is_running() && !ended_) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    server_.stop();
    thread_.join();
  }

  Result<void> open(int port) {
    port_ = port > 0 ? (server_.bind_to_port(kLoopback, port) ? port : -1) : server_.bind_to_any_port(kLoopback);
    if (port_ <= 0) {
      return tl::unexpected(
          Fault{Cause::system, "", "control port " + std::to_string(port) + " on 127.0.0.1 cannot be had", {}});
    }
    thread_ = std::thread([this] {
      server_.listen_after_bind();
      ended_ = true;
    });
    const auto give_up = std::chrono::steady_clock::now() + kMostWait;
    while (!server_.is_running()) {
      if (ended_ || std::chrono::steady_clock::now() > give_up) {
        return tl::unexpected(
            Fault{Cause::system, "", "control port " + std::to_string(port_) + " on 127.0.0.1 does not listen", {}});
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return {};
  }

  [[nodiscard]] int port() const override { return port_; }

 private:
  static void no_route(const std::string& path, httplib::Response& response) {
    answer(response, 404, {{"error", "there is no route " + path + ": " + mend_for_unknown(path, kRoutes, "")}});
  }

  /// A POST; `body` is empty when it had none.
  void obey(const std::string& path, const std::string& body, httplib::Response& response) {
    if (path == "/fault") return switch_fault(body, response);
    if (path == "/clear_faults") {
      faults_.clear();
    } else if (path == "/reset_peaks") {
      const std::lock_guard lock(world_mutex_);
      world_.reset_peaks();
    } else {
      return no_route(path, response);
    }
    answer(response, 200, {{"ok", true}});
  }

  void take_picture(const std::string& name, httplib::Response& response) {
    const auto camera = std::find_if(rig_.cameras.begin(), rig_.cameras.end(),
                                     [&](const PictureCamera& known) { return known.name == name; });
    if (camera == rig_.cameras.end()) return answer(response, 404, {{"error", "the rig has no such camera"}});
    const auto picture = cameras_.take(*camera);
    if (!picture) return answer(response, 500, {{"error", picture.error().detail}});
    response.set_content(*picture, "image/x-portable-floatmap");
  }

  void switch_fault(const std::string& body, httplib::Response& response) {
    const auto json = nlohmann::json::parse(body, nullptr, /*allow_exceptions=*/false);
    constexpr std::string_view kKeys[] = {"device", "fault", "on", "value"};
    if (json.is_object()) {
      for (const auto& [key, value] : json.items()) {
        if (std::find(std::begin(kKeys), std::end(kKeys), key) != std::end(kKeys)) continue;
        answer(response, 400, {{"error", "unknown key \"" + key + "\": " + mend_for_unknown(key, kKeys, "")}});
        return;
      }
    }
    if (!json.is_object() || !json.contains("device") || !json["device"].is_string() || !json.contains("fault") ||
        !json["fault"].is_string() || !json.contains("on") || !json["on"].is_boolean() ||
        (json.contains("value") && !json["value"].is_number())) {
      answer(response, 400, {{"error", R"(send {"device":"…","fault":"…","on":true or false,"value":number?})"}});
      return;
    }
    std::optional<double> value;
    if (json.contains("value")) value = json["value"].get<double>();
    const auto set = faults_.set_named(rig_, json["device"].get<std::string>(), json["fault"].get<std::string>(),
                                       json["on"].get<bool>(), value);
    if (set) {
      answer(response, 200, {{"ok", true}});
    } else {
      answer(response, 400, {{"error", set.error().detail}});
    }
  }

  const Rig& rig_;
  World& world_;
  Faults& faults_;
  std::mutex& world_mutex_;
  SimulatedCameras cameras_;
  httplib::Server server_;
  std::thread thread_;
  std::atomic<bool> ended_ = false;  // the thread has nothing more to do
  int port_ = 0;
};

}  // namespace

Result<std::unique_ptr<ControlHttp>> ControlHttp::open(const Rig& rig, World& world, Faults& faults,
                                                       std::mutex& world_mutex, int port, std::uint64_t seed) {
  auto server = std::make_unique<Server>(rig, world, faults, world_mutex, seed);
  if (auto opened = server->open(port); !opened) return tl::unexpected(opened.error());
  return server;
}

}  // namespace luxrig::sim
