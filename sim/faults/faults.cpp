#include "sim/faults/faults.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/text/nearest.h"
#include "sim/world/random.h"

namespace luxrig::sim {
namespace {

struct FaultEntry {
  FaultKind kind;
  std::string_view name;
  double fallback, least, most;  // of its value
  std::string_view does;         // its effect, for a person
};

constexpr std::array<FaultEntry, 22> kFaults = {{
    {FaultKind::lost, "lost", 0.5, 0, 1, "value of the answers, or of the frames to it, go missing (a share)"},
    {FaultKind::silent, "silent", 1, 0, 1,
     "gets everything, answers nothing; a bus or DMX fixture: what is sent has no effect either"},
    {FaultKind::dead, "dead", 1, 0, 1,
     "bus: its socket is closed, a USB widget unplugged; device: as silent; axis: no power"},
    {FaultKind::slow, "slow", 300, 0, 60000, "answers value ms late, in order"},
    {FaultKind::garbled, "garbled", 1, 0, 1, "answers changed, cut short or too long, a different way each time"},
    {FaultKind::stuck, "stuck", 1, 0, 1, "meter: shows for ever what it showed; axis: something blocks it"},
    {FaultKind::lying, "lying", 0.5, 0, 1000, "meter: shows value times what it should"},
    {FaultKind::exception, "exception", 4, 1, 127, "answers with Modbus exception code value"},
    {FaultKind::unpowered, "unpowered", 1, 0, 1,
     "no power: no light, no answer; afterwards its registers are as when power comes"},
    {FaultKind::checksum, "checksum", 1, 0, 1, "serial line: a wrong checksum"},
    {FaultKind::truncated, "truncated", 2, 1, 255, "serial line: the last value bytes are missing"},
    {FaultKind::gap, "gap", 600, 0, 60000, "serial line: a pause of value ms in the middle"},
    {FaultKind::noise, "noise", 2, 1, 200, "serial line: value bytes of line noise before the answer"},
    {FaultKind::wrong_unit, "wrong_unit", 1, 0, 1, "serial line: the number of another unit"},
    {FaultKind::wrong_function, "wrong_function", 1, 0, 1, "serial line: the number of another function"},
    {FaultKind::duplicated, "duplicated", 0.5, 0, 1,
     "frames of an axis or CAN bus, answers of a Modbus unit, DMX packets of a network go out twice, with probability "
     "value"},
    {FaultKind::reordered, "reordered", 0.5, 0, 1,
     "DMX packets of a network are overtaken by the next, with probability value"},
    {FaultKind::reset, "reset", 1, 0, 1, "axis: its electronics begin anew when this is switched on, as by a watchdog"},
    {FaultKind::unmappable, "unmappable", 1, 1, 3,
     "axis: no PDO can carry its profile speed and accelerations; value: 1 cannot be mapped, 2 too long, 3 out of "
     "range"},
    {FaultKind::bus_off, "bus_off", 1, 0, 1, "CAN bus: Luxrig's controller is off the bus"},
    {FaultKind::lamp_failure, "lamp_failure", 1, 0, 1,
     "fixture: its lamp gives no light; on Modbus a product with failure bits says so in them"},
    {FaultKind::pressed, "pressed", 1, 0, 1, "bus with a blackout contact: somebody presses it"},
}};

constexpr FaultKind kOnLine[] = {FaultKind::checksum, FaultKind::truncated,  FaultKind::gap,
                                 FaultKind::noise,    FaultKind::wrong_unit, FaultKind::wrong_function};

const FaultEntry& entry_of(FaultKind kind) {
  return *std::find_if(kFaults.begin(), kFaults.end(), [kind](const FaultEntry& entry) { return entry.kind == kind; });
}

constexpr auto kKinds = [] {
  std::array<FaultKind, kFaults.size()> kinds{};
  for (std::size_t i = 0; i < kFaults.size(); ++i) kinds[i] = kFaults[i].kind;
  return kinds;
}();

bool rig_has(const Rig& rig, const std::string& device) {
  const auto named = [&device](const auto& item) { return item.name == device; };
  const auto has_axis = [&device](const Fixture& fixture) {
    return fixture.axes && (pan_axis_name(fixture) == device || tilt_axis_name(fixture) == device);
  };
  if (std::any_of(rig.fixtures.begin(), rig.fixtures.end(), has_axis)) return true;
  return std::any_of(rig.fixtures.begin(), rig.fixtures.end(), named) ||
         std::any_of(rig.luxmeters.begin(), rig.luxmeters.end(), named) ||
         std::any_of(rig.buses.begin(), rig.buses.end(), named);
}

tl::unexpected<Fault> invalid(const std::string& device, std::string detail) {
  return tl::unexpected(Fault{Cause::invalid, device, std::move(detail), {}});
}

}  // namespace

std::string_view name_of(FaultKind kind) { return entry_of(kind).name; }

std::optional<FaultKind> fault_named(std::string_view name) {
  for (const FaultEntry& entry : kFaults) {
    if (entry.name == name) return entry.kind;
  }
  return std::nullopt;
}

std::span<const FaultKind> all_faults() { return kKinds; }

FaultRange range_of(FaultKind kind) {
  const FaultEntry& entry = entry_of(kind);
  const bool valued = entry.does.find("value") != std::string_view::npos;
  return {valued, entry.least, entry.most, entry.fallback, entry.does};
}

std::string faults_in_words() {
  std::string text;
  for (const FaultKind kind : kKinds) {
    const FaultRange range = range_of(kind);
    text += fmt::format(
        "  {:<15} {}{}\n", name_of(kind), range.does,
        range.valued ? fmt::format("; value {:g} to {:g}, default {:g}", range.least, range.most, range.fallback) : "");
  }
  return text;
}

void Faults::set(const std::string& device, FaultKind kind, bool on, std::optional<double> value) {
  const std::lock_guard lock(mutex_);
  ++revision_;
  if (kind == FaultKind::stuck) stuck_at_lx_.erase(device);
  if (on) {
    on_[{device, kind}] = value.value_or(entry_of(kind).fallback);
  } else {
    on_.erase({device, kind});
  }
  any_ = !on_.empty();
}

Result<void> Faults::set_named(const Rig& rig, const std::string& device, std::string_view fault, bool on,
                               std::optional<double> value) {
  const auto kind = fault_named(fault);
  if (!kind) {
    std::vector<std::string_view> known;
    for (const FaultEntry& entry : kFaults) known.push_back(entry.name);
    std::string mend(nearest_name(fault, known));
    mend = mend.empty() ? fmt::format("use one of {}", fmt::join(known, ", ")) : "did you mean '" + mend + "'?";
    return invalid(device, fmt::format("unknown fault '{}': {}", fault, mend));
  }
  if (!rig_has(rig, device)) {
    return invalid(
        device, fmt::format("the rig has no device '{}': name a fixture, an axis of one, a luxmeter or a bus", device));
  }
  const FaultEntry& entry = entry_of(*kind);
  if (value && !(*value >= entry.least && *value <= entry.most)) {
    return invalid(device, fmt::format("value {} of fault '{}' is out of range: use {} to {}", *value, fault,
                                       entry.least, entry.most));
  }
  set(device, *kind, on, value);
  return {};
}

void Faults::clear() {
  const std::lock_guard lock(mutex_);
  ++revision_;
  on_.clear();
  any_ = false;
  stuck_at_lx_.clear();
}

std::vector<FaultOn> Faults::all_on() const {
  const std::lock_guard lock(mutex_);
  std::vector<FaultOn> on;
  for (const auto& [of, value] : on_) on.push_back({of.first, of.second, value});
  return on;
}

std::optional<double> Faults::find(const std::string& device, FaultKind kind) const {
  if (!any_) return std::nullopt;
  const std::lock_guard lock(mutex_);
  const auto found = on_.find({device, kind});
  return found == on_.end() ? std::nullopt : std::optional(found->second);
}

Disturbance Faults::disturbance(std::span<const std::string> devices, std::uint64_t counter) const {
  const std::lock_guard lock(mutex_);
  Disturbance disturbance;
  if (on_.empty()) return disturbance;
  disturbance.random = random_bits(seed_, Draw::fault_garble, 0, counter);
  for (std::size_t d = 0; d < devices.size(); ++d) {
    const auto first = on_.lower_bound({devices[d], FaultKind{}});
    if (first == on_.end() || first->first.first != devices[d]) continue;
    const auto value = [&](FaultKind kind) {
      const auto found = on_.find({devices[d], kind});
      return found == on_.end() ? std::nullopt : std::optional(found->second);
    };
    if (value(FaultKind::silent) || value(FaultKind::dead) || value(FaultKind::unpowered)) disturbance.silent = true;
    if (const auto share = value(FaultKind::lost); share && random_unit(seed_, Draw::fault_loss, d, counter) < *share) {
      disturbance.silent = true;
    }
    if (const auto late_ms = value(FaultKind::slow)) {
      disturbance.delay = std::max(disturbance.delay, from_seconds(*late_ms * 1e-3));
    }
    if (value(FaultKind::garbled)) disturbance.garbled = true;
    for (const FaultKind kind : kOnLine) {
      const auto how_much = value(kind);
      if (!how_much) continue;
      disturbance.on_line = kind;
      disturbance.on_line_value = *how_much;
    }
    if (const auto share = value(FaultKind::duplicated);
        share && random_unit(seed_, Draw::fault_duplicate, d, counter) < *share) {
      disturbance.duplicated = true;
    }
    if (const auto share = value(FaultKind::reordered);
        share && random_unit(seed_, Draw::fault_reorder, d, counter) < *share) {
      disturbance.reordered = true;
    }
    if (const auto code = value(FaultKind::exception)) disturbance.exception = static_cast<int>(*code);
  }
  return disturbance;
}

double Faults::shown_lx(const std::string& meter, double honest_lx) {
  if (!any_) return honest_lx;
  const std::lock_guard lock(mutex_);
  double shown_lx = honest_lx;
  if (const auto factor = on_.find({meter, FaultKind::lying}); factor != on_.end()) shown_lx *= factor->second;
  if (on_.contains({meter, FaultKind::stuck})) {
    shown_lx = stuck_at_lx_.try_emplace(meter, shown_lx).first->second;
  }
  return shown_lx;
}

}  // namespace luxrig::sim
