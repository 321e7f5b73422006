#include "core/rig/reading/dmx_slots.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <set>

#include "core/text/nearest.h"

namespace luxrig {
namespace {

// In the order of SlotUse; a constant is followed by its number.
constexpr std::string_view kSlotNames[] = {"dimmer",    "dimmer-fine", "dimmer-ultra", "pan",        "pan-fine",
                                           "pan-ultra", "tilt",        "tilt-fine",    "tilt-ultra", "zoom",
                                           "zoom-fine", "zoom-ultra",  "constant:",    "unused"};
constexpr std::string_view kEmitter = "emitter:", kFine = "-fine", kUltra = "-ultra";

std::string_view slot_name(SlotUse use) { return kSlotNames[static_cast<std::size_t>(use)]; }

std::string emitter_slot(const std::string& emitter, SlotUse use = SlotUse::dimmer) {
  return fmt::format("{}{}{}", kEmitter, emitter,
                     use == SlotUse::dimmer_fine    ? kFine
                     : use == SlotUse::dimmer_ultra ? kUltra
                                                    : "");
}

/// ["emitter:red", "emitter:green"], for copying.
std::string slots_for(const SlotOwner& owner) {
  std::string text;
  for (const std::string& emitter : owner.emitters)
    text += fmt::format("{}\"{}\"", text.empty() ? "" : ", ", emitter_slot(emitter));
  return text;
}

bool dims(SlotUse use) { return use == SlotUse::dimmer || use == SlotUse::dimmer_fine || use == SlotUse::dimmer_ultra; }

class SlotReader {
 public:
  /// turned_elsewhere: its pan and tilt are drives on another bus.
  SlotReader(const std::optional<SlotOwner>& owner, bool turned_elsewhere, ProblemList& problems)
      : owner_(owner), turned_elsewhere_(turned_elsewhere), problems_(problems) {}

  std::optional<NamedSlot> slot(const std::string& text, const FilePosition& in_file) {
    if (text.starts_with(slot_name(SlotUse::constant))) return constant(text, in_file);
    if (text.starts_with(kEmitter)) return of_emitter(text, in_file);
    const auto* at = std::find(std::begin(kSlotNames), std::end(kSlotNames), text);
    if (at == std::end(kSlotNames)) {
      problems_.add(in_file, fmt::format("no slot is called {}", in_quotes(text)),
                    mend_for_unknown(text, kSlotNames, "see `slots` in rigs/REFERENCE.md"));
      return std::nullopt;
    }
    const auto use = static_cast<SlotUse>(at - std::begin(kSlotNames));
    if (dims(use) && has_emitters()) {
      problems_.add(in_file,
                    fmt::format("slot {} of a fixture whose luminaire {} has emitters", in_quotes(text),
                                in_quotes(owner_->luminaire)),
                    fmt::format("name the emitter it sets ({}); hold a master dimmer open with \"constant:255\"",
                                slots_for(*owner_)));
      return std::nullopt;
    }
    return NamedSlot{{use, 0}, std::nullopt, in_file};
  }

  /// Checks that the slots of a fixture fit together.
  bool check(const std::vector<NamedSlot>& slots, const FilePosition& list) {
    bool good = true;
    std::set<std::pair<SlotUse, std::size_t>> uses;
    for (const NamedSlot& slot : slots) {
      const SlotUse use = slot.slot.use;
      if (use == SlotUse::constant || use == SlotUse::unused || uses.emplace(use, slot.emitter.value_or(0)).second)
        continue;
      problems_.add(slot.in_file, fmt::format("a second {} slot", title(use, slot.emitter)),
                    "leave one; a further cell or lamp is a fixture of its own");
      good = false;
    }
    const auto has = [&](SlotUse use, std::size_t emitter) { return uses.contains({use, emitter}); };
    const auto fine_has_coarse = [&](SlotUse fine, SlotUse coarse, std::optional<std::size_t> emitter) {
      if (!has(fine, emitter.value_or(0)) || has(coarse, emitter.value_or(0))) return;
      problems_.add(
          list, fmt::format("a {} slot without a {} slot", title(fine, emitter), title(coarse, emitter)),
          fmt::format("add \"{}\" where that byte is, or make the fine one \"unused\"", title(coarse, emitter)));
      good = false;
    };
    fine_has_coarse(SlotUse::pan_fine, SlotUse::pan, std::nullopt);
    fine_has_coarse(SlotUse::pan_ultra, SlotUse::pan_fine, std::nullopt);
    fine_has_coarse(SlotUse::tilt_fine, SlotUse::tilt, std::nullopt);
    fine_has_coarse(SlotUse::tilt_ultra, SlotUse::tilt_fine, std::nullopt);
    fine_has_coarse(SlotUse::zoom_fine, SlotUse::zoom, std::nullopt);
    fine_has_coarse(SlotUse::zoom_ultra, SlotUse::zoom_fine, std::nullopt);
    const std::size_t levels = has_emitters() ? owner_->emitters.size() : 1;
    for (std::size_t e = 0; e < levels; ++e) {
      const auto emitter = has_emitters() ? std::optional(e) : std::nullopt;
      fine_has_coarse(SlotUse::dimmer_fine, SlotUse::dimmer, emitter);
      fine_has_coarse(SlotUse::dimmer_ultra, SlotUse::dimmer_fine, emitter);
      if (!owner_ || has(SlotUse::dimmer, e) || has(SlotUse::dimmer_fine, e)) continue;
      if (emitter) {
        problems_.add(list, fmt::format("no slot for emitter {}", in_quotes(owner_->emitters[e])),
                      fmt::format("add \"{}\" where it is; an emitter that stays dark does not belong in the luminaire",
                                  title(SlotUse::dimmer, emitter)));
      } else {
        problems_.add(list, "no dimmer slot", "add \"dimmer\": every fixture is set by its level");
      }
      good = false;
    }
    if (has(SlotUse::pan, 0) != has(SlotUse::tilt, 0)) {
      problems_.add(list, has(SlotUse::pan, 0) ? "a pan slot without a tilt slot" : "a tilt slot without a pan slot",
                    "give both, or hold the one with \"constant:N\"");
      good = false;
    }
    if (has(SlotUse::zoom, 0) && !turned_elsewhere_ && !(has(SlotUse::pan, 0) && has(SlotUse::tilt, 0))) {
      problems_.add(list, "a zoom slot without pan and tilt slots",
                    "hold it with \"constant:N\", and give its luminaire the beam angle that it makes then");
      good = false;
    }
    return good;
  }

 private:
  [[nodiscard]] bool has_emitters() const { return owner_ && !owner_->emitters.empty(); }
  [[nodiscard]] std::string title(SlotUse use, std::optional<std::size_t> emitter) const {
    return emitter && dims(use) ? emitter_slot(owner_->emitters[*emitter], use) : std::string(slot_name(use));
  }

  std::optional<NamedSlot> constant(const std::string& text, const FilePosition& in_file) {
    int value = -1;
    const char* end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data() + slot_name(SlotUse::constant).size(), end, value);
    if (error == std::errc{} && stop == end && value >= 0 && value <= 255)
      return NamedSlot{{SlotUse::constant, value}, std::nullopt, in_file};
    problems_.add(in_file, fmt::format("slot {} has no value from 0 to 255", in_quotes(text)),
                  "write it as \"constant:255\"");
    return std::nullopt;
  }

  std::optional<NamedSlot> of_emitter(const std::string& text, const FilePosition& in_file) {
    if (!owner_) return NamedSlot{{SlotUse::unused, 0}, std::nullopt, in_file};
    if (!has_emitters()) {
      problems_.add(
          in_file,
          fmt::format("slot {}, but luminaire {} has no emitters", in_quotes(text), in_quotes(owner_->luminaire)),
          "write \"dimmer\", or give the luminaire its emitters");
      return std::nullopt;
    }
    const bool fine = text.ends_with(kFine), ultra = text.ends_with(kUltra);
    const std::size_t ending = fine ? kFine.size() : ultra ? kUltra.size() : 0;
    const std::string name = text.substr(kEmitter.size(), text.size() - kEmitter.size() - ending);
    const auto at = std::find(owner_->emitters.begin(), owner_->emitters.end(), name);
    if (at == owner_->emitters.end()) {
      const std::vector<std::string_view> known(owner_->emitters.begin(), owner_->emitters.end());
      problems_.add(in_file,
                    fmt::format("luminaire {} has no emitter {}", in_quotes(owner_->luminaire), in_quotes(name)),
                    mend_for_unknown(name, known, "add it to the luminaire's emitters"));
      return std::nullopt;
    }
    const SlotUse use = fine ? SlotUse::dimmer_fine : ultra ? SlotUse::dimmer_ultra : SlotUse::dimmer;
    return NamedSlot{{use, 0}, static_cast<std::size_t>(at - owner_->emitters.begin()), in_file};
  }

  const std::optional<SlotOwner>& owner_;
  bool turned_elsewhere_;
  ProblemList& problems_;
};

}  // namespace

bool read_slots(Section& s, const std::optional<SlotOwner>& owner, std::vector<NamedSlot>& slots) {
  ProblemList& problems = s.problems();
  if (!s.has("slots")) {
    if (!owner || owner->emitters.empty()) {
      slots = {{DmxSlot{}, std::nullopt, s.in_file()}};
      return true;
    }
    problems.add(s.in_file(),
                 fmt::format("[[fixture]] has no \"slots\", which its luminaire {} with emitters needs",
                             in_quotes(owner->luminaire)),
                 fmt::format("add slots = [{}], in the order of its DMX footprint", slots_for(*owner)));
    return false;
  }
  std::vector<std::pair<std::string, FilePosition>> texts;
  if (!s.read_texts("slots", texts)) return false;
  SlotReader reader(owner, s.has("axes_bus"), problems);
  for (const auto& [text, in_file] : texts) {
    if (auto slot = reader.slot(text, in_file)) slots.push_back(*slot);
    if (problems.full()) break;
  }
  return slots.size() == texts.size() && reader.check(slots, s.place_of("slots"));
}

std::vector<DmxSlot> slots_of(std::span<const NamedSlot> slots, std::optional<std::size_t> emitter) {
  std::vector<DmxSlot> own;
  for (const NamedSlot& named : slots) {
    DmxSlot slot = named.slot;
    if (emitter && named.emitter && *named.emitter != *emitter) slot.use = SlotUse::unused;
    slot.sent = !emitter || *emitter == 0 || named.emitter.has_value();
    own.push_back(slot);
  }
  return own;
}

}  // namespace luxrig
