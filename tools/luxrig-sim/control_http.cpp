#include "tools/luxrig-sim/control_http.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "core/text/nearest.h"
#include "tools/command_line/installed.h"
#include "tools/http/json_body.h"
#include "tools/http/server.h"

namespace luxrig::sim {
namespace {

constexpr std::string_view kRoutes[] = {"/",      "/truth", "/rig",      "/picture",      "/fault",
                                        "/shade", "/cover", "/daylight", "/clear_faults", "/reset_peaks"};
constexpr double kMostDaylight = 1000;
constexpr double kLeastUnderexposed = 1e-3, kMostUnderexposed = 1e6;
constexpr int kUsualPasses = 24, kMostPasses = 256;

HttpResponse json_answer(const nlohmann::json& json) {
  return {200, "application/json", json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)};
}

/// The refusal of a key that the route does not know.
std::optional<HttpResponse> unknown_key(const nlohmann::json& json, std::span<const std::string_view> keys) {
  if (!json.is_object()) return std::nullopt;
  for (const auto& [key, value] : json.items()) {
    if (std::find(keys.begin(), keys.end(), key) == keys.end())
      return http_refusal(400, "unknown key \"" + key + "\": " + mend_for_unknown(key, keys, ""));
  }
  return std::nullopt;
}

class Server final : public ControlHttp {
 public:
  explicit Server(const ControlParts& parts)
      : parts_(parts), cameras_(parts.rig, parts.world, parts.world_mutex, parts.deviations), server_(options()) {
    in_the_light_.shade.assign(parts_.rig.points.size(), 1);
    in_the_light_.cover.assign(parts_.rig.luxmeters.size(), 1);
  }

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
           const std::lock_guard lock(parts_.world_mutex);
           return HttpResponse{200, "application/json",
                               truth_json(parts_.rig, parts_.world, parts_.faults, in_the_light_)};
         }},
        {"GET", "/rig",
         [this](const HttpRequest&) {
           return HttpResponse{200, "application/json", parts_.rig_json};
         }},
        {"GET", "/picture", [this](const HttpRequest& request) { return take_picture(request); }},
        {"POST", "/fault", [this](const HttpRequest& request) { return switch_fault(request.body); }},
        {"POST", "/shade",
         [this](const HttpRequest& request) {
           return set_share(request.body, "point", parts_.rig.points, in_the_light_.shade,
                            [this](std::size_t point, double share) { parts_.world.set_shade(point, share); });
         }},
        {"POST", "/cover",
         [this](const HttpRequest& request) {
           return set_share(request.body, "luxmeter", parts_.rig.luxmeters, in_the_light_.cover,
                            [this](std::size_t meter, double share) { parts_.world.set_cover(meter, share); });
         }},
        {"POST", "/daylight", [this](const HttpRequest& request) { return set_daylight(request.body); }},
        {"POST", "/clear_faults",
         [this](const HttpRequest&) {
           parts_.faults.clear();
           return json_answer({{"ok", true}});
         }},
        {"POST", "/reset_peaks",
         [this](const HttpRequest&) {
           const std::lock_guard lock(parts_.world_mutex);
           parts_.world.reset_peaks();
           return json_answer({{"ok", true}});
         }},
    };
    const std::string page = (shared_folder() / "sim-page").string();
    for (const char* file : {"/", "/page.js", "/page.css"}) {
      options.routes.push_back({"GET", file, [page, file](const HttpRequest&) { return static_file(page, file); }});
    }
    options.no_route = [](const std::string& path) {
      return "there is no route " + path + ": " + mend_for_unknown(path, kRoutes, "");
    };
    options.headers = {{"X-Content-Type-Options", "nosniff"},
                       {"X-Frame-Options", "DENY"},
                       {"Referrer-Policy", "no-referrer"},
                       {"Content-Security-Policy", "default-src 'self'; img-src data:; frame-ancestors 'none'"}};
    return options;
  }

  HttpResponse take_picture(const HttpRequest& request) {
    const std::string name = request.parameter("camera").value_or("");
    const auto underexposed = request.parameter("underexposed"), passes = request.parameter("passes");
    const auto camera = std::find_if(parts_.rig.cameras.begin(), parts_.rig.cameras.end(),
                                     [&](const PictureCamera& known) { return known.name == name; });
    if (camera == parts_.rig.cameras.end()) return http_refusal(404, "the rig has no such camera");
    double times = 1;
    if (underexposed) {
      const char* const end = underexposed->data() + underexposed->size();
      const auto [stopped, error] = std::from_chars(underexposed->data(), end, times);
      if (error != std::errc() || stopped != end || !(times >= kLeastUnderexposed && times <= kMostUnderexposed))
        return http_refusal(400, fmt::format("underexposed={} is out of range: use {:g} to {:g}", *underexposed,
                                             kLeastUnderexposed, kMostUnderexposed));
    }
    int samples = kUsualPasses;
    if (passes) {
      const char* const end = passes->data() + passes->size();
      const auto [stopped, error] = std::from_chars(passes->data(), end, samples);
      if (error != std::errc() || stopped != end || samples < 1 || samples > kMostPasses)
        return http_refusal(400, fmt::format("passes={} is out of range: use 1 to {}", *passes, kMostPasses));
    }
    auto picture = cameras_.take(static_cast<std::size_t>(camera - parts_.rig.cameras.begin()), times, samples);
    if (!picture) return http_refusal(500, picture.error().detail);
    return {200, "image/x-portable-floatmap", std::move(*picture)};
  }

  HttpResponse switch_fault(const std::string& body) {
    const auto json = json_body(body);
    constexpr std::string_view kKeys[] = {"device", "fault", "on", "value"};
    if (const auto refused = unknown_key(json, kKeys)) return *refused;
    if (!json.is_object() || !json.contains("device") || !json["device"].is_string() || !json.contains("fault") ||
        !json["fault"].is_string() || !json.contains("on") || !json["on"].is_boolean() ||
        (json.contains("value") && !json["value"].is_number())) {
      return http_refusal(400, R"(send {"device":"…","fault":"…","on":true or false,"value":number?})");
    }
    std::optional<double> value;
    if (json.contains("value")) value = json["value"].get<double>();
    const auto set = parts_.faults.set_named(parts_.rig, json["device"].get<std::string>(),
                                             json["fault"].get<std::string>(), json["on"].get<bool>(), value);
    return set ? json_answer({{"ok", true}}) : http_refusal(400, set.error().detail);
  }

  /// {"<what>":"name","value":0…1}: the share of light that reaches the named thing.
  template <class Named>
  HttpResponse set_share(const std::string& body, std::string_view what, const std::vector<Named>& things,
                         std::vector<double>& shares, const std::function<void(std::size_t, double)>& set) {
    const auto json = json_body(body);
    const std::string_view keys[] = {what, "value"};
    if (const auto refused = unknown_key(json, keys)) return *refused;
    const std::string key(what);
    if (!json.is_object() || !json.contains(key) || !json[key].is_string() || !json.contains("value") ||
        !json["value"].is_number()) {
      return http_refusal(400, fmt::format(R"(send {{"{}":"…","value":0 to 1}})", what));
    }
    const auto name = json[key].get<std::string>();
    const auto found =
        std::find_if(things.begin(), things.end(), [&](const Named& thing) { return thing.name == name; });
    if (found == things.end()) {
      std::vector<std::string_view> known;
      for (const Named& thing : things) known.push_back(thing.name);
      return http_refusal(400, fmt::format("the rig has no {} \"{}\": {}", what, name,
                                           mend_for_unknown(name, known, "this rig has none")));
    }
    const double share = json["value"].get<double>();
    if (!(share >= 0 && share <= 1))
      return http_refusal(400,
                          fmt::format("value {} is out of range: use 0 (no light) to 1 (nothing in the way)", share));
    const auto index = static_cast<std::size_t>(found - things.begin());
    const std::lock_guard lock(parts_.world_mutex);
    set(index, share);
    shares[index] = share;
    return json_answer({{"ok", true}});
  }

  HttpResponse set_daylight(const std::string& body) {
    const auto json = json_body(body);
    constexpr std::string_view kKeys[] = {"value"};
    if (const auto refused = unknown_key(json, kKeys)) return *refused;
    if (!json.is_object() || !json.contains("value") || !json["value"].is_number())
      return http_refusal(400, R"(send {"value":0 to 1000})");
    if (!parts_.rig.daylight) return http_refusal(400, "this rig has no daylight: add [daylight] to the rig file");
    const double factor = json["value"].get<double>();
    if (!(factor >= 0 && factor <= kMostDaylight))
      return http_refusal(400, fmt::format("value {} is out of range: use 0 to {:g} times the rig file's daylight",
                                           factor, kMostDaylight));
    const std::lock_guard lock(parts_.world_mutex);
    parts_.world.set_daylight(factor);
    in_the_light_.daylight = factor;
    return json_answer({{"ok", true}});
  }

  ControlParts parts_;
  InTheLight in_the_light_;  ///< guarded by the world's mutex
  SimulatedCameras cameras_;
  int port_ = 0;
  HttpServer server_;  // last: its threads use the others
};

}  // namespace

Result<std::unique_ptr<ControlHttp>> ControlHttp::open(const ControlParts& parts, int port) {
  auto server = std::make_unique<Server>(parts);
  if (auto opened = server->open(port); !opened) return tl::unexpected(opened.error());
  return server;
}

}  // namespace luxrig::sim
