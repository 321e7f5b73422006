#include "core/rig/rig_file.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>

#include <algorithm>
#include <fstream>

#include "core/rig/reading/rig_reader.h"
#include "core/text/nearest.h"
#include "core/text/plain_text.h"

namespace luxrig {
namespace {

enum class Reach { loopback, beyond_loopback };
/// Of an address in digits; nullopt if it is none.
std::optional<Reach> reach_of(const std::string& address) {
  in_addr four{};
  in6_addr six{};
  if (::inet_pton(AF_INET, address.c_str(), &four) == 1)
    return ntohl(four.s_addr) >> 24 == 127 ? Reach::loopback : Reach::beyond_loopback;
  if (::inet_pton(AF_INET6, address.c_str(), &six) == 1)
    return IN6_IS_ADDR_LOOPBACK(&six) ? Reach::loopback : Reach::beyond_loopback;
  return std::nullopt;
}

constexpr std::size_t kMaxRigBytes = std::size_t{16} << 20;

tl::unexpected<std::vector<Problem>> refuse(const std::filesystem::path& file, std::string what, std::string mend) {
  return tl::unexpected(std::vector<Problem>{{file.string(), 0, 0, std::move(what), std::move(mend)}});
}

}  // namespace

void NameIndex::add(const std::string& name, std::size_t index, const FilePosition& in_file, ProblemList& problems) {
  const auto [at, is_new] = entries_.try_emplace(name, Entry{index, in_file});
  if (is_new) return;
  problems.add(in_file,
               fmt::format("a second {} is called {} (the first is in line {})", kind_, in_quotes(name),
                           at->second.in_file.line),
               fmt::format("give each {} its own name", kind_));
}

std::optional<std::size_t> NameIndex::find(const std::string& name) const {
  const auto at = entries_.find(name);
  return at == entries_.end() ? std::nullopt : std::optional(at->second.index);
}

std::optional<std::size_t> NameIndex::read_reference(Section& section, std::string_view key) const {
  std::string name;
  if (!section.read(key, name)) return std::nullopt;
  if (const auto index = find(name)) return index;
  if (section.problems().full()) return std::nullopt;
  std::vector<std::string_view> known;
  known.reserve(entries_.size());
  for (const auto& [known_name, entry] : entries_) known.push_back(known_name);
  // In file order, whatever the order of the hash table.
  std::sort(known.begin(), known.end(), [&](std::string_view a, std::string_view b) {
    return entries_.find(std::string(a))->second.index < entries_.find(std::string(b))->second.index;
  });
  section.problems().add(section.place_of(key), fmt::format("there is no {} {}", kind_, in_quotes(name)),
                         mend_for_unknown(name, known, fmt::format("add a [[{}]] of that name", kind_)));
  return std::nullopt;
}

void RigReader::each(const NodeTable& table, std::string_view section, const std::function<void(Section&)>& body) {
  each_section(table, section, problems, body);
}

std::optional<std::filesystem::path> RigReader::read_file(Section& section, std::string_view key) {
  std::string text;
  if (!section.read(key, text)) return std::nullopt;
  std::filesystem::path path = folder / text;
  std::error_code error;
  if (std::filesystem::is_regular_file(path, error)) return path;
  const bool exists = !error && std::filesystem::exists(path, error);
  problems.add(section.place_of(key),
               fmt::format("{} {}", in_quotes(text), exists ? "is not a file" : "does not exist"),
               fmt::format("put the file there, or correct the path (it starts from the folder of {})",
                           rig.file.filename().empty() ? "the rig file" : rig.file.filename().string()));
  return std::nullopt;
}

void RigReader::read_settings() {
  if (!luxrig::find(root, "rig")) {
    problems.add({1, 1}, "there is no [rig]", "begin with [rig] and a line name = \"…\" below it");
  }
  each(root, "rig", [&](Section& s) { s.read("name", rig.name); });
  each(root, "limits", [&](Section& s) {
    rig.limits.in_file = s.in_file();
    s.read("max_level", rig.limits.max_level);
    s.read("open_loop_margin", rig.limits.open_loop_margin);
    s.read("max_watts", rig.limits.max_watts);
  });
  each(root, "control", [&](Section& s) {
    ControlSpec& c = rig.control;
    c.in_file = s.in_file();
    s.read("fade_s", c.fade_s);
    s.read_choice("fade_curve", c.fade_curve);
    s.read("correction_fade_s", c.correction_fade_s);
    s.read("settle_s", c.settle_s);
    s.read("rounds", c.rounds);
    s.read("tolerance", c.tolerance);
    s.read("goal_tolerance", c.goal_tolerance);
    s.read("fault_dips", c.fault_dips);
    s.read("gain_min", c.gain_min);
    s.read("gain_max", c.gain_max);
  });
  each(root, "safe", [&](Section& s) {
    rig.safe.in_file = s.in_file();
    s.read("hold_s", rig.safe.hold_s);
    s.read("fade_s", rig.safe.fade_s);
    s.read_choice("scope", rig.safe.scope);
    s.read("on_meter_loss", rig.safe.on_meter_loss);
    if (s.read("level", rig.safe.level) && rig.safe.level > rig.limits.max_level) {
      problems.add(s.place_of("level"),
                   fmt::format("level {} of the safe look is above max_level {} of [limits]", rig.safe.level,
                               rig.limits.max_level),
                   "lower it, or raise that limit");
    }
  });
  each(root, "daemon", [&](Section& s) {
    rig.daemon.in_file = s.in_file();
    s.read("http_port", rig.daemon.http_port);
    // Not read_file(): a rig is checked on other computers, too, and these files stay on one.
    const auto read_path = [&](const char* key, std::filesystem::path& path) {
      std::string written;
      if (s.read(key, written)) path = folder / written;
    };
    DaemonSpec& d = rig.daemon;
    read_path("accounts", d.accounts_file);
    read_path("tls_certificate", d.tls_certificate_file);
    read_path("tls_key", d.tls_key_file);
    s.read("behind_proxy", d.behind_proxy);
    if (d.tls_certificate_file.empty() != d.tls_key_file.empty())
      problems.add(s.in_file(), "a certificate and its key belong together", "give both tls_certificate and tls_key");
    if (d.behind_proxy && d.accounts_file.empty())
      problems.add(s.place_of("behind_proxy"), "behind a proxy, nobody but this computer's user could log in",
                   "name a file with accounts = \"accounts.json\"");
    if (s.read("listen", d.listen)) {
      const auto reach = reach_of(d.listen);
      if (!reach)
        problems.add(s.place_of("listen"), fmt::format("{} is no address in digits", in_quotes(d.listen)),
                     "write one of this computer, such as 192.168.1.5, or 0.0.0.0 for all");
      if (reach == Reach::beyond_loopback && (d.accounts_file.empty() || d.tls_certificate_file.empty()))
        problems.add(s.place_of("listen"),
                     fmt::format("beyond this computer, at {}, the page needs accounts and a certificate", d.listen),
                     "name files with accounts, tls_certificate and tls_key; behind a proxy on this computer leave "
                     "listen out");
    }
    s.read("park_at_end", rig.daemon.park_at_end);
  });
}

void RigReader::read_all() {
  report_unknown_sections(root, SectionSpec::File::rig, "", problems);
  read_settings();
  read_scene();
  read_daylight();
  read_luminaires();
  read_buses();
  read_points();  // before fixtures and meters, which refer to points
  read_fixtures();
  read_luxmeters();
  read_cameras();
  patches.report(rig.buses, problems);
  read_mounting();
  read_keep_outs();
  read_startup();
  read_tasks();  // they refer to luminaires, fixtures, objects and points, and need goals
}

Checked<Rig> parse_rig(std::string_view text, const std::filesystem::path& file, const std::filesystem::path& folder,
                       PaintedPoints painted) {
  if (text.size() > kMaxRigBytes) {
    return refuse(file, fmt::format("the file has {} bytes", text.size()),
                  "a rig file may have at most 16 MiB; put many points into a [points] file");
  }
  const Checked<NodeTable> document = parse_document(text, file.string());
  if (!document) return tl::unexpected(document.error());
  RigReader reader(*document, file, folder, painted);
  reader.read_all();
  if (!reader.problems.empty()) return tl::unexpected(reader.problems.take());
  return std::move(reader.rig);
}

Checked<Rig> load_rig(const std::filesystem::path& path, PaintedPoints painted) {
  std::error_code error;
  const std::filesystem::path file = std::filesystem::is_directory(path, error) ? path / "rig.toml" : path;
  if (!std::filesystem::is_regular_file(file, error)) {
    return refuse(file, std::filesystem::exists(file, error) ? "not a file" : "no such file",
                  "name a rig file, or a folder with a rig.toml in it");
  }
  std::ifstream in(file, std::ios::binary);
  std::string text;
  // One byte beyond the limit shows that a file is too long.
  text.resize(kMaxRigBytes + 1);
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!in.is_open() || in.bad()) return refuse(file, "the file cannot be read", "check who may read it");
  text.resize(static_cast<std::size_t>(in.gcount()));
  return parse_rig(text, file, file.parent_path(), painted);
}

}  // namespace luxrig
