#include "tools/luxrig/calibrate/simulated_hand.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>

#include "core/calibration/rig_light.h"

namespace luxrig {
namespace {

/// Of a good luxmeter's calibration (as usual_priors() takes it).
constexpr double kGain = 0.01;
/// A lamp has come to rest, and the meter's display.
constexpr auto kSettles = std::chrono::milliseconds(600);

}  // namespace

SimulatedHand::SimulatedHand(HttpPeer sim_control, const std::string& world)
    : control_(std::move(sim_control)),
      random_(std::hash<std::string>{}(world)),
      gain_(1 + kGain * std::normal_distribution<double>()(random_)) {}

Result<HandAnswer> SimulatedHand::read(const Point& point, const std::stop_token& stop) {
  const auto fault = [](std::string what) { return tl::unexpected(Fault{Cause::system, "", std::move(what), {}}); };
  std::this_thread::sleep_for(kSettles);
  if (stop.stop_requested()) return tl::unexpected(Fault{Cause::cancelled, "", "stopped", {}});
  const auto answer = http_get(control_, "/truth");
  if (!answer || answer->status != 200) return fault("the simulated rig does not answer");
  const auto truth = nlohmann::json::parse(answer->body, nullptr, false);
  if (!truth.is_object() || !truth.contains("points") || !truth["points"].is_array())
    return fault("the simulated rig's truth is no JSON");
  for (const auto& one : truth["points"]) {
    if (!one.is_object() || one.value("name", "") != point.name || !one.contains("lux") || !one["lux"].is_number())
      continue;
    const double lux = gain_ * one["lux"].get<double>();
    const double read_lx = lux + error_in_hand_lx(lux) * std::normal_distribution<double>()(random_);
    return HandAnswer{HandAnswer::What::reading, std::max(0.0, read_lx)};
  }
  return fault(fmt::format("the simulated rig has no point \"{}\"", point.name));
}

}  // namespace luxrig
