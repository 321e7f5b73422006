#include "tools/luxrig-sim/control_http.h"

#include <algorithm>
#include <vector>

#include "core/text/nearest.h"
#include "tools/http/json_body.h"
#include "tools/http/server.h"

namespace luxrig::sim {
namespace {

constexpr std::string_view kRoutes[] = {"/truth", "/picture", "/fault", "/clear_faults", "/reset_peaks"};

HttpResponse json_answer(const nlohmann::json& json) {
  return {200, "application/json", json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)};
}

class Server final : public ControlHttp {
 public:
  Server(const Rig& rig, World& world, Faults& faults, std::mutex& world_mutex, std::uint64_t seed)
      : rig_(rig),
        world_(world),
        faults_(faults),
        world_mutex_(world_mutex),
        cameras_(rig, world, world_mutex, seed),
        server_(options()) {}

  Result<void> open(int port) {
    const auto bound = server_.bind(port);
    if (!bound) {
      return tl::unexpected(
          Fault{Cause::system, "", "control port " + std::to_string(port) + " on 127.0.0.1 cannot be had", {}});
    }
    port_ = *bound;
    server_.start();
    return {};
  }

  [[nodiscard]] int port() const override { return port_; }

 private:
  HttpServerOptions options() {
    HttpServerOptions options;
    options.routes = {
        {"GET", "/truth",
         [this](const HttpRequest&) {
           const std::lock_guard lock(world_mutex_);
           return HttpResponse{200, "application/json", truth_json(rig_, world_)};
         }},
        {"GET", "/picture",
         [this](const HttpRequest& request) { return take_picture(request.parameter("camera").value_or("")); }},
        {"POST", "/fault", [this](const HttpRequest& request) { return switch_fault(request.body); }},
        {"POST", "/clear_faults",
         [this](const HttpRequest&) {
           faults_.clear();
           return json_answer({{"ok", true}});
         }},
        {"POST", "/reset_peaks",
         [this](const HttpRequest&) {
           const std::lock_guard lock(world_mutex_);
           world_.reset_peaks();
           return json_answer({{"ok", true}});
         }},
    };
    options.no_route = [](const std::string& path) {
      return "there is no route " + path + ": " + mend_for_unknown(path, kRoutes, "");
    };
    return options;
  }

  HttpResponse take_picture(const std::string& name) {
    const auto camera = std::find_if(rig_.cameras.begin(), rig_.cameras.end(),
                                     [&](const PictureCamera& known) { return known.name == name; });
    if (camera == rig_.cameras.end()) return http_refusal(404, "the rig has no such camera");
    auto picture = cameras_.take(*camera);
    if (!picture) return http_refusal(500, picture.error().detail);
    return {200, "image/x-portable-floatmap", std::move(*picture)};
  }

  HttpResponse switch_fault(const std::string& body) {
    const auto json = json_body(body);
    constexpr std::string_view kKeys[] = {"device", "fault", "on", "value"};
    if (json.is_object()) {
      for (const auto& [key, value] : json.items()) {
        if (std::find(std::begin(kKeys), std::end(kKeys), key) != std::end(kKeys)) continue;
        return http_refusal(400, "unknown key \"" + key + "\": " + mend_for_unknown(key, kKeys, ""));
      }
    }
    if (!json.is_object() || !json.contains("device") || !json["device"].is_string() || !json.contains("fault") ||
        !json["fault"].is_string() || !json.contains("on") || !json["on"].is_boolean() ||
        (json.contains("value") && !json["value"].is_number())) {
      return http_refusal(400, R"(send {"device":"…","fault":"…","on":true or false,"value":number?})");
    }
    std::optional<double> value;
    if (json.contains("value")) value = json["value"].get<double>();
    const auto set = faults_.set_named(rig_, json["device"].get<std::string>(), json["fault"].get<std::string>(),
                                       json["on"].get<bool>(), value);
    return set ? json_answer({{"ok", true}}) : http_refusal(400, set.error().detail);
  }

  const Rig& rig_;
  World& world_;
  Faults& faults_;
  std::mutex& world_mutex_;
  SimulatedCameras cameras_;
  int port_ = 0;
  HttpServer server_;  // last: its threads use the others
};

}  // namespace

Result<std::unique_ptr<ControlHttp>> ControlHttp::open(const Rig& rig, World& world, Faults& faults,
                                                       std::mutex& world_mutex, int port, std::uint64_t seed) {
  auto server = std::make_unique<Server>(rig, world, faults, world_mutex, seed);
  if (auto opened = server->open(port); !opened) return tl::unexpected(opened.error());
  return server;
}

}  // namespace luxrig::sim
