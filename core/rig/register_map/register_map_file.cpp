#include "core/rig/register_map/register_map_file.h"

#include <fmt/format.h>

#include <fstream>
#include <functional>
#include <map>

#include "core/rig/reading/section.h"
#include "core/rig/register_map/register_value.h"
#include "core/text/nearest.h"

namespace luxrig {
namespace {

constexpr std::size_t kMaxMapBytes = std::size_t{1} << 20;
constexpr std::size_t kMaxMapped = 4096;  // numbers of one product

/// Types as written in the file.
enum class RegisterType { u16, s16, u32, s32, float32 };

class MapReader {
 public:
  MapReader(const NodeTable& root, const std::string& file) : root_(root), problems_(file) {}

  Checked<RegisterMap> read() {
    report_unknown_sections(root_, SectionSpec::File::register_map, "a register map", problems_);
    if (!luxrig::find(root_, "device")) {
      problems_.add({1, 1}, "there is no [device]", "begin with [device] and the product's name and source below it");
    }
    each("device", [&](Section& s) { read_device(s); });
    each("register", [&](Section& s) { read_register(s); });
    each("setup", [&](Section& s) { read_setup(s); });
    check_overlaps();
    if (!problems_.empty()) return tl::unexpected(problems_.take());
    return std::move(map_);
  }

 private:
  void each(std::string_view name, const std::function<void(Section&)>& body) {
    each_section(root_, name, problems_, body);
  }

  void read_device(Section& s) {
    s.read("name", map_.name);
    s.read("source", map_.source);
    std::vector<std::pair<std::string, FilePosition>> assumed;
    s.read_texts("assumed", assumed);
    for (auto& [text, in_file] : assumed) map_.assumed.push_back(std::move(text));
    const auto read_ms = [&](std::string_view key) -> std::optional<Duration> {
      double ms = 0;
      return s.read(key, ms) ? std::optional(from_seconds(ms * 1e-3)) : std::nullopt;
    };
    map_.answer_time = read_ms("answer_ms");
    map_.shortest_gap = read_ms("shortest_gap_ms").value_or(Duration{});
    s.read("largest_read", map_.largest_read);
    s.read("largest_write", map_.largest_write);
    s.read("baud_rates", map_.baud_rates);
    s.read_choice("when_data_stops", map_.when_data_stops);
    double after_s = 0;
    if (s.read("stops_after_s", after_s)) map_.stops_after = from_seconds(after_s);
    if (map_.when_data_stops == DataLoss::hold) {
      s.refuse("stops_after_s", "stops_after_s has no effect: the product holds its levels when data stops",
               "remove it, or say dark or watchdog in when_data_stops");
    } else if (!s.has("stops_after_s")) {
      s.require("stops_after_s", "which says when its levels go out");
    }
    if (map_.when_data_stops == DataLoss::watchdog && luxrig::find(root_, "setup") == nullptr) {
      problems_.add(s.place_of("when_data_stops"), "nothing arms the watchdog",
                    "add [[setup]] entries that write its registers, or say dark if it is always on");
    }
  }

  void read_format(Section& s, MappedRegister& reg) {
    RegisterType type = RegisterType::u16;
    s.read_choice("type", type);
    reg.format.registers = type == RegisterType::u16 || type == RegisterType::s16 ? 1 : 2;
    reg.format.number = type == RegisterType::float32                            ? RegisterNumber::floating
                        : type == RegisterType::s16 || type == RegisterType::s32 ? RegisterNumber::signed_whole
                                                                                 : RegisterNumber::whole;
    s.read_choice("byte_order", reg.format.low_byte_first);
    if (s.read_choice("word_order", reg.format.low_word_first) && reg.format.registers == 1) {
      problems_.add(s.place_of("word_order"), "word_order has no effect: the value is in one register",
                    "remove it, or choose a type of 32 bits");
    }
  }

  /// A bit is only 0 or 1.
  void check_bit(Section& s, MappedRegister& reg) {
    for (const std::string_view key : {"type", "word_order", "byte_order", "scale", "unit", "range"}) {
      s.refuse(key,
               fmt::format("{} has no effect: a {} is one bit", key,
                           reg.table == RegisterTable::coil ? "coil" : "discrete input"),
               "remove it");
    }
    reg.format = {};
    reg.range_raw = {0, 1};
    if (reg.power_on_raw < 0 || reg.power_on_raw > 1) {
      problems_.add(s.place_of("power_on"), fmt::format("power_on {} of one bit", reg.power_on_raw), "choose 0 or 1");
      reg.power_on_raw = 0;
    }
    if (reg.role == RegisterRole::illuminance)
      problems_.add(s.place_of("what"), "an illuminance of one bit", "say kind input or holding");
  }

  /// Requirements of a role on the other keys.
  void check_role(Section& s, MappedRegister& reg) {
    const auto wrong = [&](std::string_view key, std::string what, std::string mend) {
      problems_.add(s.place_of(key), std::move(what), std::move(mend));
    };
    const bool input = reg.table == RegisterTable::input, discrete = reg.table == RegisterTable::discrete;
    if ((input || discrete) && reg.access != RegisterAccess::read_only) {
      if (s.has("access"))
        wrong("access", fmt::format("{} can only be read", input ? "an input register" : "a discrete input"),
              fmt::format("say access = \"read\", or kind {}", input ? "holding" : "coil"));
      reg.access = RegisterAccess::read_only;
    }
    if (is_bit(reg.table)) check_bit(s, reg);
    if (reg.role == RegisterRole::failure && (!is_bit(reg.table) || reg.access == RegisterAccess::write_only)) {
      wrong("what", "a failure that is no bit which can be read", "say kind discrete, or kind coil, or call it status");
    }
    if (reg.role == RegisterRole::level) {
      if (reg.access == RegisterAccess::read_only) {
        wrong("what", "a level that cannot be written", "correct kind or access, or say what it is");
      }
      s.refuse("scale", "scale has no effect: a level runs from 0 to 1 over its range", "remove it");
      if (!s.has("range") && !is_bit(reg.table)) s.require("range", "whose two ends are dark and full");
    }
    if (reg.role == RegisterRole::illuminance) {
      if (reg.access == RegisterAccess::write_only) {
        wrong("access", "an illuminance that cannot be read", "correct access, or say what it is");
      }
      if (s.has("unit") && reg.unit != "lx") {
        wrong("unit", fmt::format("an illuminance in {}", in_quotes(reg.unit)), "choose scale so that its unit is lx");
      }
      reg.unit = "lx";
    }
    const auto [least, most] = register_limits(reg.format);
    if (reg.range_raw && (reg.range_raw->first < least || reg.range_raw->second > most)) {
      wrong("range",
            fmt::format("range {:g} to {:g} does not fit its type, which holds {:g} to {:g}", reg.range_raw->first,
                        reg.range_raw->second, least, most),
            "choose another type or range");
    }
    if (reg.role == RegisterRole::level && reg.range_raw &&
        (reg.range_raw->first < 0 || reg.range_raw->second > 65535)) {
      wrong("range", "a level runs within 0 to 65535 of its register", "choose such a range");
    }
    if (reg.power_on_raw < least || reg.power_on_raw > most) {
      wrong("power_on", fmt::format("power_on {} does not fit its type", reg.power_on_raw), "choose another");
    }
  }

  void read_register(Section& s) {
    MappedRegister reg;
    reg.in_file = s.in_file();
    bool good = s.read("name", reg.name);
    s.read_choice("what", reg.role);
    good &= s.read("address", reg.address);
    s.read_choice("kind", reg.table);
    read_format(s, reg);
    s.read("scale", reg.scale);
    s.read("unit", reg.unit);
    s.read_choice("access", reg.access);
    s.read("range", reg.range_raw);
    s.read("power_on", reg.power_on_raw);
    check_role(s, reg);
    int count = 1, step = reg.format.registers;
    s.read("count", count);
    if (s.read("step", step) && step < reg.format.registers) {
      problems_.add(s.place_of("step"), fmt::format("step {} is less than the registers of one", step),
                    fmt::format("use {} or more", reg.format.registers));
      good = false;
    }
    if (!good) return;
    if (reg.address + (count - 1) * step + reg.format.registers > 65536) {
      problems_.add(s.place_of("address"), "its registers end past register 65535", "use a lower address or count");
      return;
    }
    for (int i = 0; i < count; ++i) {
      if (map_.registers.size() >= kMaxMapped) {
        if (!too_many_) problems_.add(s.in_file(), fmt::format("more than {} registers", kMaxMapped), "leave some out");
        too_many_ = true;
        return;
      }
      MappedRegister one = reg;
      if (count > 1) one.name = fmt::format("{}{}", reg.name, i + 1);
      one.address += i * step;
      one.of_several = count > 1 ? i + 1 : 0;
      if (!names_.try_emplace(one.name, map_.registers.size()).second) {
        problems_.add(s.place_of("name"), fmt::format("a second register is called {}", in_quotes(one.name)),
                      "give each its own name");
        return;
      }
      map_.registers.push_back(std::move(one));
    }
  }

  void read_setup(Section& s) {
    std::string name;
    SetupWrite write;
    const bool has_value = s.read("value", write.value_raw);
    if (!s.read("register", name)) return;
    const auto found = names_.find(name);
    if (found == names_.end()) {
      std::vector<std::string_view> known;
      for (const MappedRegister& reg : map_.registers) known.push_back(reg.name);
      problems_.add(s.place_of("register"), fmt::format("there is no register {}", in_quotes(name)),
                    mend_for_unknown(name, known, "add a [[register]] of that name"));
      return;
    }
    write.index = found->second;
    const MappedRegister& reg = map_.registers[write.index];
    if (reg.access == RegisterAccess::read_only) {
      problems_.add(s.place_of("register"), fmt::format("{} cannot be written", in_quotes(name)),
                    "name another register, or correct its access");
      return;
    }
    const auto [least, most] = reg.range_raw.value_or(register_limits(reg.format));
    if (has_value && (write.value_raw < least || write.value_raw > most)) {
      problems_.add(s.place_of("value"), fmt::format("{} cannot hold {}", in_quotes(name), write.value_raw),
                    fmt::format("choose a value in {:g} to {:g}", least, most));
      return;
    }
    map_.setup.push_back(write);
  }

  void check_overlaps() {
    std::map<std::pair<RegisterTable, int>, std::size_t> taken;  // by table and address
    for (std::size_t i = 0; i < map_.registers.size(); ++i) {
      const MappedRegister& reg = map_.registers[i];
      for (int word = 0; word < reg.format.registers; ++word) {
        const auto [at, is_new] = taken.try_emplace({reg.table, reg.address + word}, i);
        if (is_new) continue;
        if (problems_.full()) return;
        const MappedRegister& other = map_.registers[at->second];
        problems_.add(reg.in_file,
                      fmt::format("{} and {} (line {}) share {} register {}", in_quotes(reg.name),
                                  in_quotes(other.name), other.in_file.line, name_of(reg.table), reg.address + word),
                      "give each its own address");
        break;
      }
    }
  }

  const NodeTable& root_;
  ProblemList problems_;
  RegisterMap map_;
  std::map<std::string, std::size_t, std::less<>> names_;
  bool too_many_ = false;
};

}  // namespace

Checked<RegisterMap> parse_register_map(std::string_view text, const std::string& file) {
  if (text.size() > kMaxMapBytes) {
    return tl::unexpected(std::vector<Problem>{
        {file, 0, 0, fmt::format("the file has {} bytes", text.size()), "a register map may have at most 1 MiB"}});
  }
  const Checked<NodeTable> document = parse_document(text, file);
  if (!document) return tl::unexpected(document.error());
  return MapReader(*document, file).read();
}

Checked<RegisterMap> load_register_map(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::string text(kMaxMapBytes + 1, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!in.is_open() || in.bad()) {
    return tl::unexpected(
        std::vector<Problem>{{path.string(), 0, 0, "the file cannot be read", "check who may read it"}});
  }
  text.resize(static_cast<std::size_t>(in.gcount()));
  return parse_register_map(text, path.string());
}

}  // namespace luxrig
