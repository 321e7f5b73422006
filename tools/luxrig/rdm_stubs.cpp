#include "tools/luxrig/rdm_stubs.h"

#include <fmt/format.h>

#include <map>
#include <set>

namespace luxrig {
namespace {

constexpr std::uint8_t kPrimary = 0, kFine = 1;

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char letter : text) {
    if (letter == '"' || letter == '\\') out += '\\';
    out += letter;
  }
  return out + "\"";
}

std::string unique_name(const rdm::DeviceProfile& profile, std::set<std::string>& taken) {
  const std::string wish = profile.label.empty() ? rdm::text_of(profile.uid) : profile.label;
  std::string name = wish;
  for (int number = 2; !taken.insert(name).second; ++number) name = fmt::format("{}-{}", wish, number);
  return name;
}

}  // namespace

std::vector<std::string> slot_names(const rdm::DeviceProfile& profile) {
  if (profile.slots.empty()) return {};
  std::vector<std::string> names(static_cast<std::size_t>(profile.info.footprint_slots), "unused");
  std::map<int, std::string> uses;  // offset of a coarse slot -> "pan"
  std::set<std::string> taken;
  for (const rdm::SlotInfo& slot : profile.slots) {
    if (slot.type != kPrimary || slot.offset >= profile.info.footprint_slots) continue;
    const std::string use = slot.label == rdm::kIntensitySlot ? "dimmer"
                            : slot.label == rdm::kPanSlot     ? "pan"
                            : slot.label == rdm::kTiltSlot    ? "tilt"
                            : slot.label == rdm::kZoomSlot    ? "zoom"
                                                              : "";
    if (use.empty() || !taken.insert(use).second) continue;  // the first of several
    uses[slot.offset] = names[static_cast<std::size_t>(slot.offset)] = use;
  }
  for (const rdm::SlotInfo& slot : profile.slots) {
    if (slot.type != kFine || slot.offset >= profile.info.footprint_slots) continue;
    const auto coarse = uses.find(slot.label);
    if (coarse == uses.end()) continue;
    std::string& name = names[static_cast<std::size_t>(slot.offset)];
    for (const char* finer : {"-fine", "-ultra"}) {
      if (!taken.insert(coarse->second + finer).second) continue;
      name = coarse->second + finer;
      break;
    }
  }
  return names;
}

std::string fixture_stubs(const std::vector<PatchedDevice>& devices) {
  std::string text = "# Found by `luxrig rdm list` on Art-Net universes. Lines with FILL IN need a person.\n";
  std::set<std::string> taken;
  for (const PatchedDevice& device : devices) {
    const rdm::DeviceProfile& profile = device.profile;
    if (!profile.info.start_address) continue;
    text += fmt::format("\n[[fixture]]  # {}: {} {}, personality {} of {}, {} slots\n", rdm::text_of(profile.uid),
                        profile.manufacturer, profile.model, profile.info.personality, profile.info.personalities,
                        profile.info.footprint_slots);
    text += fmt::format("name = {}\n", quoted(unique_name(profile, taken)));
    text +=
        "# FILL IN: luminaire = \"…\", position_m = [x, y, z], and where it looks; bus = \"…\" (driver = \"artnet\")\n";
    text += fmt::format("universe = {}\naddress = {}\n", device.universe, *profile.info.start_address);
    const std::vector<std::string> names = slot_names(profile);
    if (names.empty()) {
      text += fmt::format("# FILL IN: slots = [\"dimmer\", …]: what its {} slots are, it does not say\n",
                          profile.info.footprint_slots);
      continue;
    }
    std::string list;
    for (const std::string& name : names) list += fmt::format("{}\"{}\"", list.empty() ? "" : ", ", name);
    text += fmt::format("slots = [{}]\n", list);
  }
  return text;
}

}  // namespace luxrig
