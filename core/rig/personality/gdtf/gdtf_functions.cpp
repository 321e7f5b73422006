#include "core/rig/personality/gdtf/gdtf_functions.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/rig/personality/dmx_value.h"
#include "core/text/plain_text.h"

namespace luxrig {
namespace {

constexpr std::size_t kMaxFunctions = 512, kMaxSets = 1024;

std::uint32_t highest_of(int bytes) { return bytes >= 4 ? 0xFFFFFFFFu : (1u << (8 * bytes)) - 1; }

class FunctionReader {
 public:
  FunctionReader(const XmlFile& xml, int bytes, Personality& personality, ProblemList& problems)
      : xml_(xml), bytes_(bytes), personality_(personality), problems_(problems) {}

  GdtfFunctions read(const pugi::xml_node& channel) {
    for (const pugi::xml_node& logical : channel.children("LogicalChannel")) {
      for (const pugi::xml_node& node : logical.children("ChannelFunction")) {
        if (out_.functions.size() == kMaxFunctions) {
          problems_.add(xml_.place_of(node), fmt::format("more than {} functions of a channel", kMaxFunctions),
                        "do not trust the file");
          return std::move(out_);
        }
        read_function(logical, node);
      }
    }
    end_functions();
    for (std::size_t f = 0; f < out_.functions.size(); ++f) read_sets(nodes_[f], out_.functions[f]);
    set_default(channel);
    return std::move(out_);
  }

 private:
  std::uint32_t value(const pugi::xml_node& node, const char* name, std::uint32_t fallback) {
    const std::string text = plain_attribute(node, name);
    if (text.empty() || text == "None") return fallback;
    if (const auto dmx = dmx_value(text, bytes_)) return *dmx;
    problems_.add(xml_.place_of(node), fmt::format("{} {} is no DMX value", name, in_quotes(text)),
                  "write it as value/bytes, the value within those bytes: 255/1, 65535/2");
    return fallback;
  }

  void read_function(const pugi::xml_node& logical, const pugi::xml_node& node) {
    ChannelFunction function;
    function.attribute = plain_attribute(node, "Attribute");
    if (function.attribute.empty()) function.attribute = plain_attribute(logical, "Attribute");
    function.name = plain_attribute(node, "Name");
    if (function.name.empty())  // the standard's own default name
      function.name = fmt::format("{} {}", function.attribute, out_.functions.size() + 1);
    function.dmx.from = value(node, "DMXFrom", 0);
    function.default_dmx = value(node, "Default", function.dmx.from);
    function.physical_from = number_attribute(node, "PhysicalFrom", 0);
    function.physical_to = number_attribute(node, "PhysicalTo", 1);
    function.real_fade_s = std::clamp(number_attribute(node, "RealFade", 0), 0.0, 3600.0);
    function.emitter = plain_attribute(node, "Emitter");
    const std::string profile = plain_attribute(node, "DMXProfile");
    for (std::size_t p = 0; p < personality_.profiles.size() && !profile.empty(); ++p)
      if (personality_.profiles[p].name == profile) function.profile = p;
    GdtfCondition condition{plain_attribute(node, "ModeMaster"), plain_attribute(node, "ModeFrom"),
                            plain_attribute(node, "ModeTo")};
    if (condition.master == "None") condition.master.clear();
    out_.functions.push_back(std::move(function));
    out_.conditions.push_back(std::move(condition));
    nodes_.push_back(node);
  }

  void end_functions() {
    const auto alike = [](const GdtfCondition& a, const GdtfCondition& b) {
      return a.master == b.master && (a.master.empty() || (a.from == b.from && a.to == b.to));
    };
    for (std::size_t f = 0; f < out_.functions.size(); ++f) {
      std::uint32_t& to = out_.functions[f].dmx.to = highest_of(bytes_);
      for (std::size_t g = 0; g < out_.functions.size(); ++g) {
        const std::uint32_t next = out_.functions[g].dmx.from;
        if (next > out_.functions[f].dmx.from && alike(out_.conditions[f], out_.conditions[g]))
          to = std::min(to, next - 1);
      }
    }
  }

  void read_sets(const pugi::xml_node& node, ChannelFunction& function) {
    std::vector<pugi::xml_node> set_nodes;
    for (const pugi::xml_node& set_node : node.children("ChannelSet")) {
      if (set_nodes.size() == kMaxSets) return;
      ChannelSet set;
      set.name = plain_attribute(set_node, "Name");
      const std::string from = plain_attribute(set_node, "DMXFrom");
      const auto dmx = from.empty() ? std::optional(function.dmx.from) : dmx_value(from, bytes_);
      // A set only names a part of its function. The fixture also works without a wrong one.
      if (!dmx || !function.dmx.contains(*dmx)) {
        if (personality_.notes.size() < 50) {
          personality_.notes.push_back(fmt::format("line {}: set {} at {} does not lie within its function; left out",
                                                   xml_.place_of(set_node).line, in_quotes(set.name), in_quotes(from)));
        }
        continue;
      }
      set.dmx.from = *dmx;
      function.sets.push_back(std::move(set));
      set_nodes.push_back(set_node);
    }
    std::vector<std::uint32_t> starts;
    for (const ChannelSet& set : function.sets) starts.push_back(set.dmx.from);
    std::sort(starts.begin(), starts.end());
    for (std::size_t s = 0; s < function.sets.size(); ++s) {
      ChannelSet& set = function.sets[s];
      const auto next = std::upper_bound(starts.begin(), starts.end(), set.dmx.from);
      set.dmx.to = next == starts.end() ? function.dmx.to : *next - 1;
      set.physical_from = number_attribute(set_nodes[s], "PhysicalFrom", function.physical_at(set.dmx.from));
      set.physical_to = number_attribute(set_nodes[s], "PhysicalTo", function.physical_at(set.dmx.to));
    }
  }

  void set_default(const pugi::xml_node& channel) {
    if (out_.functions.empty()) return;
    const std::string initial = plain_attribute(channel, "InitialFunction");
    const ChannelFunction* first = &out_.functions.front();
    for (const ChannelFunction& function : out_.functions) {
      // Channel.LogicalAttribute.Function
      if (!initial.empty() && initial.size() > function.name.size() && initial.ends_with("." + function.name)) {
        first = &function;
        break;
      }
    }
    out_.default_dmx = value(channel, "Default", first->default_dmx);  // of the channel itself: before version 1.1
  }

  const XmlFile& xml_;
  int bytes_;
  Personality& personality_;
  ProblemList& problems_;
  GdtfFunctions out_;
  std::vector<pugi::xml_node> nodes_;
};

}  // namespace

GdtfFunctions read_gdtf_functions(const XmlFile& xml, const pugi::xml_node& channel, int bytes,
                                  Personality& personality, ProblemList& problems) {
  return FunctionReader(xml, bytes, personality, problems).read(channel);
}

}  // namespace luxrig
