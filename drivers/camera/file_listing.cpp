#include "drivers/camera/file_listing.h"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <charconv>

namespace luxrig {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxFiles = 100'000;

bool is_digit(char letter) { return letter >= '0' && letter <= '9'; }
bool is_letter(char letter) { return (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z'); }

/// shot9 before shot10.
bool name_before(std::string_view a, std::string_view b) {
  while (!a.empty() && !b.empty()) {
    if (!is_digit(a.front()) || !is_digit(b.front())) {
      if (a.front() != b.front()) return a.front() < b.front();
      a.remove_prefix(1), b.remove_prefix(1);
      continue;
    }
    const auto digits = [](std::string_view text) {
      std::size_t zeros = 0, end = 0;
      while (end < text.size() && is_digit(text[end])) ++end;
      while (zeros + 1 < end && text[zeros] == '0') ++zeros;
      return std::pair(text.substr(zeros, end - zeros), end);
    };
    const auto [number_a, end_a] = digits(a);
    const auto [number_b, end_b] = digits(b);
    if (number_a.size() != number_b.size()) return number_a.size() < number_b.size();
    if (number_a != number_b) return number_a < number_b;
    a.remove_prefix(end_a), b.remove_prefix(end_b);
  }
  return a.size() < b.size();
}

bool is_picture_name(const fs::path& file) {
  std::string end = file.extension().string();
  for (char& letter : end) letter = static_cast<char>(letter >= 'A' && letter <= 'Z' ? letter + 32 : letter);
  return end == ".png" || end == ".pgm" || end == ".ppm" || end == ".pnm" || end == ".pfm";
}

}  // namespace

Result<std::vector<fs::path>> picture_files(const fs::path& folder_or_pattern) {
  std::error_code error;
  const bool whole_folder = fs::is_directory(folder_or_pattern, error);
  const fs::path folder = whole_folder ? folder_or_pattern : folder_or_pattern.parent_path();
  const std::string pattern = whole_folder ? "*" : folder_or_pattern.filename().string();
  std::vector<fs::path> files;
  fs::directory_iterator it(folder.empty() ? "." : folder, error);
  if (error)
    return tl::unexpected(
        Fault{Cause::network,
              {},
              fmt::format("{}: {}: write files as a folder that is there", folder.string(), error.message()),
              {}});
  for (const fs::directory_iterator end; !error && it != end && files.size() < kMaxFiles; it.increment(error))
    if (is_picture_name(it->path()) && fnmatch(pattern.c_str(), it->path().filename().c_str(), 0) == 0)
      files.push_back(it->path());
  if (files.empty())
    return tl::unexpected(
        Fault{Cause::network,
              {},
              fmt::format("{} has no picture yet: put PNG, PGM, PPM or PFM files there", folder_or_pattern.string()),
              {}});
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return name_before(a.filename().string(), b.filename().string());
  });
  return files;
}

std::optional<double> exposure_in_name(std::string_view name) {
  for (std::size_t i = 0; i < name.size(); ++i) {
    if (!is_digit(name[i]) || (i > 0 && (is_digit(name[i - 1]) || name[i - 1] == '.'))) continue;
    double number = 0;
    const auto [end, error] =
        std::from_chars(name.data() + i, name.data() + name.size(), number, std::chars_format::fixed);
    if (error != std::errc()) continue;
    const std::string_view rest(end, static_cast<std::size_t>(name.data() + name.size() - end));
    const auto stands_alone = [&](std::size_t length) { return rest.size() == length || !is_letter(rest[length]); };
    if (rest.starts_with("ms") && stands_alone(2) && number > 0) return number / 1000;
    if (rest.starts_with("s") && stands_alone(1) && number > 0) return number;
  }
  return std::nullopt;
}

}  // namespace luxrig
