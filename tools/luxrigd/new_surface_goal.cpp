#include "tools/luxrigd/new_surface_goal.h"

#include <fmt/format.h>

#include <cctype>
#include <system_error>

#include "core/goals/painting_file.h"
#include "core/rig/points_csv.h"
#include "core/rig/rig_file.h"
#include "tools/luxrig/painting_files.h"
#include "tools/process/files.h"

namespace luxrig {
namespace {

/// A file's content, to be put back; none = there was no file.
struct Before {
  std::filesystem::path file;
  std::optional<std::string> text;

  explicit Before(std::filesystem::path path) : file(std::move(path)) {
    if (auto read = read_file(file)) text = std::move(*read);
  }
  [[nodiscard]] Result<void> put_back() const {
    if (text) return write_file(file, *text);
    std::error_code error;
    std::filesystem::remove(file, error);
    return {};
  }
};

/// A TOML basic string. text: without control characters.
std::string toml_text(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) out += (c == '"' || c == '\\' ? "\\" : "") + std::string(1, c);
  return out + '"';
}

/// "Rembrandt (left)" -> "rembrandt-left".
std::string file_stem(const std::string& name) {
  std::string stem;
  for (const char c : name) {
    const auto letter = static_cast<unsigned char>(c);
    if (std::isalnum(letter) != 0)
      stem += static_cast<char>(std::tolower(letter));
    else if (!stem.empty() && stem.back() != '-')
      stem += '-';
    if (stem.size() == 60) break;
  }
  while (!stem.empty() && stem.back() == '-') stem.pop_back();
  return stem.empty() ? "painting" : stem;
}

/// In the folder, of a name that no file has.
std::filesystem::path new_strokes_file(const std::filesystem::path& folder, const std::string& name) {
  const std::string stem = file_stem(name);
  for (int number = 1;; ++number) {
    const auto file = folder / (number == 1 ? stem + ".json" : fmt::format("{}-{}.json", stem, number));
    std::error_code error;
    auto points = file;
    if (!std::filesystem::exists(file, error) && !std::filesystem::exists(points.replace_extension(".csv"), error))
      return file;
  }
}

std::string unreadable_with(const std::vector<Problem>& problems) {
  return fmt::format("the rig could not be read with it: {}", problems.front().text());
}

}  // namespace

Result<void> save_if_readable(const std::filesystem::path& rig_file, const SurfaceGoalSpec& goal,
                              const std::string& strokes, std::span<const Point> points) {
  const Before strokes_before(goal.strokes_file), points_before(goal.points_file());
  auto saved = save_painting(goal, strokes, points);
  if (!saved) return saved;
  const auto rig = load_rig(rig_file);
  if (rig) return {};
  for (const Before* before : {&strokes_before, &points_before})
    if (auto back = before->put_back(); !back) return back;
  return refusal(unreadable_with(rig.error()));
}

Result<SurfaceGoalSpec> add_surface_goal(const std::filesystem::path& rig_file, const std::string& name,
                                         const std::optional<double>& max_lx) {
  const auto text = read_file(rig_file);
  if (!text) return refusal(text.error().front().text());
  const std::filesystem::path folder = rig_file.parent_path();
  SurfaceGoalSpec goal;
  goal.name = name;
  goal.max_lx = max_lx;
  goal.strokes_file = new_strokes_file(folder, name);
  const std::string end = text->find("\r\n") == std::string::npos ? "\n" : "\r\n";
  std::string more = *text;
  if (!more.empty() && more.back() != '\n') more += end;
  more += fmt::format("{0}[[surface_goal]]{0}name = {1}{0}strokes = {2}{0}", end, toml_text(name),
                      toml_text(goal.strokes_file.filename().string()));
  if (max_lx) more += fmt::format("max_lx = {}{}", *max_lx, end);
  if (auto saved = save_painting(goal, painting_to_json({}), {}); !saved) return tl::unexpected(saved.error());
  const auto take_back = [&] {
    std::error_code error;
    std::filesystem::remove(goal.strokes_file, error);
    std::filesystem::remove(goal.points_file(), error);
  };
  const auto rig = parse_rig(more, rig_file, folder);
  if (!rig) {
    take_back();
    return refusal(unreadable_with(rig.error()));
  }
  if (auto written = write_file(rig_file, more); !written) {
    // After a fault while it was synced, it may be there.
    if (const auto now = read_file(rig_file); now && *now == *text) take_back();
    return tl::unexpected(written.error());
  }
  return rig->surface_goals.back();
}

}  // namespace luxrig
