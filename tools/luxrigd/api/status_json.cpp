#include "tools/luxrigd/api/status_json.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "tools/luxrigd/api/status_parts.h"

namespace luxrig {

void put_verdicts(nlohmann::json& out, const PointStatus& status) {
  if (std::isfinite(status.light.lux) && std::isfinite(status.light.half_width_lx)) {
    out["lux"] = status.light.lux;
    out["uncertainty_lux"] = status.light.half_width_lx;
  }
  if (status.verdict) {
    out["verdict"] = name_of(*status.verdict);
    out["reason"] = status.reason;
  }
  if (status.limit) {
    out["limit"] = name_of(*status.limit);
    out["limit_reason"] = status.limit_reason;
  }
}

void put_counts(nlohmann::json& out, const ShowStatus& show, double goal_tolerance) {
  out["goals"] = {{"met", show.goals.met},
                  {"missed", show.goals.missed},
                  {"unknown", show.goals.unknown},
                  {"tolerance", goal_tolerance}};
  out["limits"] = {{"kept", show.limits_kept}, {"exceeded", show.limits_exceeded}, {"unknown", show.limits_unknown}};
}

std::string status_json(const StatusInput& input) {
  using nlohmann::json;
  const StatusParts parts(input, StatusParts::Times::ages);
  json out = parts.rest();
  out["time_s"] = to_seconds(input.now - input.started);
  /// What it is, and how it is.
  const auto put = [&](const char* key, const auto& fixed, std::size_t count, auto&& now) {
    json& list = out[key] = json::array();
    for (std::size_t i = 0; i < count; ++i) {
      list.push_back(fixed_of(input.rig, fixed[i]));
      list.back().update(now(i));
    }
  };
  put("fixtures", input.rig.fixtures, input.show.fixtures.size(), [&](std::size_t i) { return parts.fixture(i); });
  put("points", input.rig.points, input.show.points.size(), [&](std::size_t i) { return parts.point(i); });
  put("luxmeters", input.rig.luxmeters, input.rig.luxmeters.size(), [&](std::size_t i) { return parts.luxmeter(i); });
  json& devices = out["devices"] = json::array();
  for (std::size_t i = 0; i < input.devices.size(); ++i) devices.push_back(parts.device(i));
  // Names come from files: invalid UTF-8 is replaced and never throws.
  return out.dump(-1, ' ', false, json::error_handler_t::replace);
}

}  // namespace luxrig
