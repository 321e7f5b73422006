#include "tools/luxrigd/reload_check.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/rig/problem_list.h"
#include "core/rig/register_map/register_map.h"

namespace luxrig {
namespace {

bool same(const RegisterFormat& a, const RegisterFormat& b) {
  return a.registers == b.registers && a.number == b.number && a.low_word_first == b.low_word_first &&
         a.low_byte_first == b.low_byte_first;
}

/// Register maps are compared by product name: their content is part of the program, or of a file that a reload does
/// not read again.
bool same(const std::shared_ptr<const RegisterMap>& a, const std::shared_ptr<const RegisterMap>& b) {
  return (a ? a->name : "") == (b ? b->name : "");
}

bool same(const DmxSlot& a, const DmxSlot& b) {
  return a.use == b.use && a.constant_dmx == b.constant_dmx && a.sent == b.sent && a.cell == b.cell &&
         a.travel.at_start == b.travel.at_start && a.travel.at_end == b.travel.at_end;
}

bool same(const Patch& a, const Patch& b) {
  if (a.index() != b.index()) return false;
  if (const auto* dmx = std::get_if<DmxPatch>(&a)) {
    const auto& other = std::get<DmxPatch>(b);
    return dmx->universe == other.universe && dmx->address == other.address &&
           std::equal(dmx->slots.begin(), dmx->slots.end(), other.slots.begin(), other.slots.end(),
                      [](const DmxSlot& x, const DmxSlot& y) { return same(x, y); });
  }
  const auto &one = std::get<ModbusPatch>(a), &other = std::get<ModbusPatch>(b);
  return one.unit == other.unit && one.holding_register == other.holding_register &&
         one.full_scale_raw == other.full_scale_raw && one.dark_raw == other.dark_raw && one.coil == other.coil &&
         same(one.format, other.format) && same(one.map, other.map);
}

bool same(const AxisPatch& a, const AxisPatch& b) {
  return a.node == b.node && a.counts_per_degree == b.counts_per_degree && a.home_rad == b.home_rad &&
         a.acceleration_rad_s2 == b.acceleration_rad_s2;
}

bool same(const std::optional<AxesPatch>& a, const std::optional<AxesPatch>& b) {
  if (!a || !b) return a.has_value() == b.has_value();
  return a->bus == b->bus && same(a->pan, b->pan) && same(a->tilt, b->tilt);
}

bool same(const JointRange& a, const JointRange& b) {
  return a.pan_min_rad == b.pan_min_rad && a.pan_max_rad == b.pan_max_rad && a.tilt_min_rad == b.tilt_min_rad &&
         a.tilt_max_rad == b.tilt_max_rad && a.beam_min_rad == b.beam_min_rad && a.beam_max_rad == b.beam_max_rad;
}

bool same(const Bus& a, const Bus& b) {
  return a.name == b.name && a.driver == b.driver &&
         std::equal(
             a.options.begin(), a.options.end(), b.options.begin(), b.options.end(),
             [](const auto& x, const auto& y) { return x.first == y.first && x.second.value == y.second.value; });
}

bool same(const ModbusMeterPatch& a, const ModbusMeterPatch& b) {
  return a.unit == b.unit && a.input_registers == b.input_registers && a.first_register == b.first_register &&
         a.lux_per_count == b.lux_per_count && same(a.format(), b.format()) && same(a.map, b.map);
}

bool same(const KeepOut& a, const KeepOut& b) {
  if (a.box_world_m.has_value() != b.box_world_m.has_value()) return false;
  if (a.box_world_m && (a.box_world_m->min() != b.box_world_m->min() || a.box_world_m->max() != b.box_world_m->max()))
    return false;
  return a.name == b.name && a.centre_world_m == b.centre_world_m && a.radius_m == b.radius_m &&
         a.margin_rad == b.margin_rad && a.heads == b.heads;
}

/// The output key of a fixture that differs; null if none does.
const char* output_key_that_differs(const Fixture& a, const Fixture& b) {
  if (a.name != b.name) return "name";
  if (a.bus != b.bus) return "bus";
  if (!same(a.patch, b.patch)) return "its patch (address, slots, mode or registers)";
  if (!same(a.axes, b.axes)) return "axes";
  if (a.dimmer_curve != b.dimmer_curve) return "dimmer_curve";
  if (a.measured_curve != b.measured_curve) return "its dimmer's measured curve (calibration.json)";
  if (a.switched != b.switched) return "switched";
  if (a.moves != b.moves || !same(a.range, b.range)) return "the range of its pan, tilt or zoom";
  if (a.joint_map != b.joint_map) return "how its head turns (calibration.json)";
  if (a.pan_speed_rad_s != b.pan_speed_rad_s || a.tilt_speed_rad_s != b.tilt_speed_rad_s ||
      a.zoom_speed_rad_s != b.zoom_speed_rad_s || a.reset_s != b.reset_s)
    return "its speeds";
  return nullptr;
}

bool has_limits(const Rig& rig) {
  return std::any_of(rig.points.begin(), rig.points.end(), [](const Point& point) { return point.max_lx.has_value(); });
}

bool listens_to_desks(const Rig& rig) {
  return std::any_of(rig.buses.begin(), rig.buses.end(), [](const Bus& bus) { return bus.options.contains("input"); });
}

}  // namespace

std::vector<Problem> needs_a_restart(const Rig& running, const Rig& changed, bool same_light) {
  std::vector<Problem> problems;
  const auto needs = [&](const FilePosition& in_file, const std::string& what) {
    problems.push_back({changed.file.string(), in_file.line, in_file.column,
                        what + " has changed, which needs a restart", "restart the daemon, or put it back and reload"});
  };
  if (running.name != changed.name) needs({1, 1}, "the rig's name");
  if (running.buses.size() != changed.buses.size()) needs({1, 1}, "the number of [[bus]]");
  for (std::size_t b = 0; b < std::min(running.buses.size(), changed.buses.size()); ++b)
    if (!same(running.buses[b], changed.buses[b]))
      needs(changed.buses[b].in_file, fmt::format("[[bus]] \"{}\"", changed.buses[b].name));
  if (running.fixtures.size() != changed.fixtures.size()) needs({1, 1}, "the number of [[fixture]]");
  for (std::size_t f = 0; f < std::min(running.fixtures.size(), changed.fixtures.size()); ++f)
    if (const char* key = output_key_that_differs(running.fixtures[f], changed.fixtures[f]))
      needs(changed.fixtures[f].in_file, fmt::format("[[fixture]] \"{}\": {}", changed.fixtures[f].name, key));
  if (running.luxmeters.size() != changed.luxmeters.size()) needs({1, 1}, "the number of [[luxmeter]]");
  for (std::size_t m = 0; m < std::min(running.luxmeters.size(), changed.luxmeters.size()); ++m) {
    const Luxmeter &a = running.luxmeters[m], &b = changed.luxmeters[m];
    if (a.name != b.name || a.bus != b.bus || !same(a.patch, b.patch))
      needs(b.in_file, fmt::format("[[luxmeter]] \"{}\": its name, bus or registers", b.name));
  }
  const bool same_zones =
      std::equal(running.keep_outs.begin(), running.keep_outs.end(), changed.keep_outs.begin(), changed.keep_outs.end(),
                 [](const KeepOut& a, const KeepOut& b) { return same(a, b); });
  if (!same_zones)
    needs(changed.keep_outs.empty() ? FilePosition{1, 1} : changed.keep_outs.front().in_file, "[[keep_out]]");
  if (same_zones && !changed.keep_outs.empty() && !same_light)
    needs(changed.keep_outs.front().in_file, "where things hang beside a [[keep_out]]");
  if (running.daemon.http_port != changed.daemon.http_port) needs(changed.daemon.in_file, "http_port of [daemon]");
  const DaemonSpec &was = running.daemon, &is = changed.daemon;
  const std::pair<const char*, bool> reached[] = {
      {"listen", was.listen == is.listen},
      {"accounts", was.accounts_file == is.accounts_file},
      {"tls_certificate", was.tls_certificate_file == is.tls_certificate_file},
      {"tls_key", was.tls_key_file == is.tls_key_file},
      {"behind_proxy", was.behind_proxy == is.behind_proxy}};
  for (const auto& [key, is_same] : reached)
    if (!is_same) needs(is.in_file, fmt::format("{} of [daemon]", key));
  if (running.calibrated_on != changed.calibrated_on) needs({1, 1}, "which rig calibration.json was measured on");
  // Limits decide whether a desk may turn heads.
  if (listens_to_desks(changed) && has_limits(running) != has_limits(changed))
    needs({1, 1}, "whether points have max_lux, beside a bus with an input for desks,");
  return problems;
}

}  // namespace luxrig
