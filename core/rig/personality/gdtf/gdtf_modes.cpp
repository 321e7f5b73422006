#include "core/rig/personality/gdtf/gdtf_modes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/rig/personality/dmx_value.h"
#include "core/rig/personality/gdtf/gdtf_functions.h"
#include "core/rig/personality/gdtf/gdtf_geometry.h"
#include "core/rig/personality/slot_overlap.h"
#include "core/text/plain_text.h"

namespace luxrig {
namespace {

constexpr std::size_t kMaxChannels = 2048;

/// The part of a link before its first dot: "Head_Gobo1.Gobo1.Gobo1 Index" names a function of channel Head_Gobo1.
std::string_view channel_of_link(std::string_view link) { return link.substr(0, link.find('.')); }
std::string_view function_of_link(std::string_view link) {
  const auto dot = link.rfind('.');
  return dot == std::string_view::npos || dot == link.find('.') ? std::string_view{} : link.substr(dot + 1);
}

class GdtfModeReader {
 public:
  GdtfModeReader(const XmlFile& xml, Personality& personality, std::size_t& room, ProblemList& problems)
      : xml_(xml), personality_(personality), room_(room), problems_(problems) {}

  PersonalityMode read(const pugi::xml_node& type, const pugi::xml_node& node) {
    mode_.name = plain_attribute(node, "Name");
    instances_ = gdtf_instances(xml_, type.child("Geometries"), plain_attribute(node, "Geometry"), xml_.place_of(node),
                                problems_);
    for (const GdtfInstance& instance : instances_) mode_.geometries.push_back(instance.geometry);
    if (instances_.empty()) return std::move(mode_);
    for (const pugi::xml_node& channel : node.child("DMXChannels").children("DMXChannel")) {
      read_channel(channel);
      if (problems_.full() || mode_.channels.size() > kMaxChannels || room_ == 0) break;
    }
    if (mode_.channels.size() > kMaxChannels || room_ == 0) {
      problems_.add(
          xml_.place_of(node),
          fmt::format("more than {} channels in a mode, or {} functions and sets in all", kMaxChannels, kMaxGdtfParts),
          "no such fixture is known; do not trust the file");
    }
    resolve_conditions();
    read_relations(node);
    read_macros(node);
    lay_out_slots(mode_, places_, problems_);
    set_axes();
    return std::move(mode_);
  }

 private:
  struct Link {  // as in the file, for each channel of the mode
    std::string file_name;
    std::size_t instance;
    std::vector<GdtfCondition> conditions;
  };

  void note(const pugi::xml_node& node, const std::string& text) {
    const std::string whole = fmt::format("line {}: {}", xml_.place_of(node).line, text);
    if (personality_.notes.size() < 50) personality_.notes.push_back(whole);
  }

  /// Reads "1,2" as 0-based slots, before references add to them. False and a problem if it is wrong.
  bool read_offsets(const pugi::xml_node& node, std::vector<int>& offsets) {
    const auto problem = [&] {
      problems_.add(xml_.place_of(node),
                    fmt::format("mode {}: a channel's Offset {} is no list of one to four slots from 1 to 512",
                                in_quotes(mode_.name), in_quotes(node.attribute("Offset").value())),
                    "write it as 1,2 (most significant first), or None for a virtual channel");
      return false;
    };
    std::string text = plain_attribute(node, "Offset");
    if (!node.attribute("Offset")) {  // before version 1.0
      for (const char* old : {"Coarse", "Fine", "Ultra", "Uber"}) {
        const std::string slot = plain_attribute(node, old);
        if (!slot.empty() && slot != "None" && slot != "-1") text += (text.empty() ? "" : ",") + slot;
      }
    }
    if (text.empty() || text == "None") return true;
    for (std::size_t at = 0; at <= text.size();) {
      const std::size_t comma = std::min(text.find(',', at), text.size());
      const auto slot = finite_number(std::string_view(text).substr(at, comma - at));
      if (!slot || *slot != std::floor(*slot) || *slot < 1 || *slot > 512 || offsets.size() == 4) return problem();
      offsets.push_back(static_cast<int>(*slot) - 1);
      at = comma + 1;
    }
    return true;
  }

  void read_channel(const pugi::xml_node& node) {
    PersonalityChannel channel;
    if (!read_offsets(node, channel.offsets)) return;
    const int bytes = channel.is_virtual() ? 4 : static_cast<int>(channel.offsets.size());
    GdtfFunctions read = read_gdtf_functions(xml_, node, bytes, personality_, problems_);
    if (read.functions.empty()) {
      note(node, "a channel without functions is left out");
      return;
    }
    channel.functions = std::move(read.functions);
    channel.default_dmx = read.default_dmx;
    channel.highlight_dmx = dmx_value(plain_attribute(node, "Highlight"), bytes);
    const std::string geometry = plain_attribute(node, "Geometry");
    const std::string attribute = plain_attribute(node.child("LogicalChannel"), "Attribute");
    const std::string break_text = plain_attribute(node, "DMXBreak");
    const std::string file_name = geometry + "_" + attribute;
    bool placed = false;
    for (std::size_t i = 0; i < instances_.size() && mode_.channels.size() <= kMaxChannels && room_ > 0; ++i) {
      const GdtfInstance& instance = instances_[i];
      if (instance.defined_as != geometry) continue;
      placed = true;
      PersonalityChannel own = channel;
      own.name = instance.geometry.name + "_" + attribute;
      own.geometry = i;
      set_break(node, break_text, instance, own);
      add(node, std::move(own), {file_name, i, read.conditions});
    }
    if (placed) return;
    note(node, fmt::format("channel {} acts on a geometry that its mode does not have; taken as of the whole fixture",
                           in_quotes(file_name)));
    channel.name = file_name;
    set_break(node, break_text, instances_.front(), channel);
    add(node, std::move(channel), {file_name, 0, read.conditions});
  }

  void add(const pugi::xml_node& node, PersonalityChannel channel, Link link) {
    for (const ChannelFunction& function : channel.functions) room_ -= std::min(room_, 1 + function.sets.size());
    mode_.channels.push_back(std::move(channel));
    links_.push_back(std::move(link));
    places_.push_back(xml_.place_of(node));
  }

  void set_break(const pugi::xml_node& node, const std::string& text, const GdtfInstance& instance,
                 PersonalityChannel& channel) {
    int added = 0;
    if (text == "Overwrite") {
      if (!instance.overwrite) {
        note(node, "DMXBreak \"Overwrite\" outside of a reference; taken as 1");
      } else {
        std::tie(channel.dmx_break, added) = *instance.overwrite;
      }
    } else {
      channel.dmx_break = static_cast<int>(std::clamp(finite_number(text).value_or(1), 1.0, 512.0));
      const auto at = instance.added_by_break.find(channel.dmx_break);
      if (at != instance.added_by_break.end()) added = at->second;
    }
    for (int& offset : channel.offsets) offset += added;
  }

  /// The channel that a link of channel `from` refers to: the one of its own geometry instance if there are several.
  std::optional<std::size_t> linked(std::string_view link, std::optional<std::size_t> from) const {
    const std::string_view name = channel_of_link(link);
    std::optional<std::size_t> first;
    for (std::size_t c = 0; c < links_.size(); ++c) {
      if (links_[c].file_name != name) continue;
      if (!first) first = c;
      if (from && mode_.share_a_branch(links_[c].instance, links_[*from].instance)) return c;
    }
    return first;
  }

  void resolve_conditions() {
    for (std::size_t c = 0; c < mode_.channels.size(); ++c) {
      for (std::size_t f = 0; f < links_[c].conditions.size(); ++f) {
        const GdtfCondition& condition = links_[c].conditions[f];
        ChannelFunction& function = mode_.channels[c].functions[f];
        if (condition.master.empty()) continue;
        const auto master = linked(condition.master, c);
        if (!master || *master == c) {
          if (personality_.notes.size() < 50) {
            personality_.notes.push_back(fmt::format("line {}: {} depends on {}, which its mode does not have",
                                                     places_[c].line, in_quotes(function.name),
                                                     in_quotes(condition.master)));
          }
          continue;
        }
        function.when = condition_on(*master, condition);
      }
    }
  }

  FunctionCondition condition_on(std::size_t master, const GdtfCondition& condition) const {
    const PersonalityChannel& channel = mode_.channels[master];
    const int bytes = channel.is_virtual() ? 4 : static_cast<int>(channel.offsets.size());
    DmxInterval dmx{dmx_value(condition.from, bytes).value_or(0),
                    dmx_value(condition.to, bytes).value_or(channel.max_dmx())};
    // Some files name a function and state 0 to 0 with it. Then the function's own range applies.
    const std::string_view wanted = function_of_link(condition.master);
    for (const ChannelFunction& function : channel.functions) {
      if (wanted.empty() || function.name != wanted) continue;
      if (dmx.to < function.dmx.from || dmx.from > function.dmx.to) dmx = function.dmx;
      break;
    }
    return {master, dmx};
  }

  void read_relations(const pugi::xml_node& node) {
    for (const pugi::xml_node& relation : node.child("Relations").children("Relation")) {
      const auto master = linked(plain_attribute(relation, "Master"), std::nullopt);
      const auto follower = linked(plain_attribute(relation, "Follower"), master);
      if (!master || !follower || *master == *follower || mode_.relations.size() >= kMaxChannels) {
        note(relation, "a relation between channels that the mode does not have is left out");
        continue;
      }
      mode_.relations.push_back(
          {*master, *follower,
           plain_attribute(relation, "Type") == "Override" ? RelationKind::override_follower : RelationKind::multiply});
    }
  }

  /// The best information in the file: what a macro that strikes the lamp sends, and for how long.
  void read_macros(const pugi::xml_node& node) {
    for (const pugi::xml_node& macro : node.child("FTMacros").children("FTMacro")) {
      for (const pugi::xml_node& step : macro.child("MacroDMX").children("MacroDMXStep")) {
        for (const pugi::xml_node& value : step.children("MacroDMXValue")) {
          const auto c = linked(plain_attribute(value, "DMXChannel"), std::nullopt);
          if (!c) continue;
          PersonalityChannel& channel = mode_.channels[*c];
          const int bytes = channel.is_virtual() ? 4 : static_cast<int>(channel.offsets.size());
          const auto dmx = dmx_value(plain_attribute(value, "Value"), bytes);
          if (!dmx) continue;
          for (ChannelFunction& function : channel.functions) {
            if (!function.dmx.contains(*dmx) || !strikes_lamp(function, *dmx)) continue;
            function.default_dmx = *dmx;
            function.hold_s = std::clamp(number_attribute(step, "Duration", 0), 0.0, 3600.0);
          }
        }
      }
    }
  }

  void set_axes() {
    std::optional<std::size_t> pan, tilt;
    for (const PersonalityChannel& channel : mode_.channels) {
      for (const ChannelFunction& function : channel.functions) {
        if (channel.is_virtual()) continue;
        if (function.attribute == "Pan" && !pan) pan = channel.geometry;
        if (function.attribute == "Tilt" && !tilt) tilt = channel.geometry;
      }
    }
    set_gdtf_axes(instances_, pan, tilt, mode_);
  }

  const XmlFile& xml_;
  Personality& personality_;
  std::size_t& room_;
  ProblemList& problems_;
  PersonalityMode mode_;
  std::vector<GdtfInstance> instances_;
  std::vector<Link> links_;
  std::vector<FilePosition> places_;
};

}  // namespace

PersonalityMode read_gdtf_mode(const XmlFile& xml, const pugi::xml_node& type, const pugi::xml_node& mode,
                               Personality& personality, std::size_t& room, ProblemList& problems) {
  return GdtfModeReader(xml, personality, room, problems).read(type, mode);
}

}  // namespace luxrig
