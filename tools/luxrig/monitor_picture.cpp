#include "tools/luxrig/monitor_picture.h"

#include <algorithm>
#include <cmath>

#include "tools/process/status_fields.h"
#include "tools/terminal/table.h"

namespace luxrig {
namespace {

using nlohmann::json;

constexpr int kNarrowest = 40;

/// A share 0…1 as a bar of eight cells, in eighths.
std::string bar(double share) {
  static const char* const kEighths[] = {" ", "▏", "▎", "▍", "▌", "▋", "▊", "▉"};
  const int eighths = static_cast<int>(std::lround(64 * std::clamp(share, 0.0, 1.0)));
  std::string text;
  for (int cell = 0; cell < 8; ++cell) {
    const int filled = std::clamp(eighths - 8 * cell, 0, 8);
    text += filled == 8 ? "█" : kEighths[filled];
  }
  return text;
}

/// Why a head is dark, and until when; or that it is being identified.
std::string state_of_fixture(const json& f) {
  if (flag_of(f, "identified")) return "← this one";
  const std::string why = flag_of(f, "parked") ? "parked" : flag_of(f, "kept_dark") ? "kept dark" : "";
  const std::string waits_for = text_of(f, "waits_for");
  return why.empty() || waits_for.empty() ? why : fmt::format("{}, waits for {}", why, waits_for);
}

/// Slots in rows of 8, 16, 24 or 32, each as 0…255; rows of zeros are left out.
std::string universe_picture(const json& universe, int width) {
  const json slots = list_of(universe, "slots");
  const int per_row = std::clamp((width - 6) / 4 / 8 * 8, 8, 32);
  std::string text =
      fmt::format("{}, universe {}{}\n", text_of(universe, "bus"), shown(number_of(universe, "universe"), "{:.0f}"),
                  flag_of(universe, "silent") ? ", silent: a desk sends it" : "");
  bool anything = false;
  for (std::size_t first = 0; first < slots.size(); first += static_cast<std::size_t>(per_row)) {
    const std::size_t end = std::min(slots.size(), first + static_cast<std::size_t>(per_row));
    std::string row = fmt::format("{:>4}", first + 1);
    bool lit = false;
    for (std::size_t i = first; i < end; ++i) {
      const int value = slots[i].is_number_integer() ? slots[i].get<int>() : 0;
      lit = lit || value != 0;
      row += value == 0 ? "   ·" : fmt::format(" {:>3}", value);
    }
    if (lit) text += row + "\n";
    anything = anything || lit;
  }
  return anything ? text : text + "      all at 0\n";
}

}  // namespace

std::string monitor_picture(const json& status, const json& universes, int width) {
  width = std::max(width, kNarrowest);
  std::string text = fmt::format("{}: {}{}: {}\n", text_of(status, "rig"), text_of(status, "phase"),
                                 flag_of(status, "blackout") ? ", BLACKOUT" : "", text_of(status, "detail"));
  for (const json& alarm : list_of(status, "alarms"))
    text += fmt::format("{}  {}\n", flag_of(alarm, "severe") ? "ALARM  " : "warning", text_of(alarm, "text"));
  Table devices({"device", "state", ">last ok s", ">sent", ">errors", "detail"});
  for (const json& d : list_of(status, "devices"))
    devices.row({text_of(d, "name"), text_of(d, "life"), shown(number_of(d, "last_ok_s"), "{:.1f}"),
                 shown(number_of(d, "sent"), "{:.0f}"), shown(number_of(d, "errors"), "{:.0f}"), text_of(d, "detail")});
  text += "\n" + devices.text() + "\n";
  if (universes.is_array())
    for (const json& universe : universes) text += universe_picture(universe, width) + "\n";
  const json fixtures = list_of(status, "fixtures");
  Table lamps({"fixture", ">drive", "", ">level", ">pan °", ">tilt °", ">beam °", ""});
  for (const json& f : fixtures) {
    const bool moves = flag_of(f, "moves");
    lamps.row({text_of(f, "name"), shown(number_of(f, "drive"), "{:.3f}"), bar(number_of(f, "drive").value_or(0)),
               shown(number_of(f, "level"), "{:.3f}"), moves ? shown(number_of(f, "pan_deg"), "{:.1f}") : "",
               moves ? shown(number_of(f, "tilt_deg"), "{:.1f}") : "", shown(number_of(f, "beam_angle_deg"), "{:.1f}"),
               state_of_fixture(f)});
  }
  text += lamps.text();
  const json meters = list_of(status, "luxmeters");
  if (meters.empty()) return text;
  Table lux({"luxmeter", "state", ">lx", ">age s"});
  for (const json& m : meters)
    lux.row({text_of(m, "name"), text_of(m, "life"), shown(number_of(m, "lux"), "{:.1f}"),
             shown(number_of(m, "age_s"), "{:.1f}")});
  return text + "\n" + lux.text();
}

}  // namespace luxrig
