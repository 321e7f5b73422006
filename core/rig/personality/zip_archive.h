#pragma once
/// A zip archive in memory, read as from a stranger: GDTF and MVR files are such. libzip takes it apart.

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

namespace luxrig {

inline constexpr std::size_t kMostZipBytes = std::size_t{256} << 20;
inline constexpr std::size_t kMostZipEntries = 10'000;

class ZipArchive {
 public:
  /// Refuses what is no zip archive, is larger or has more entries than stated above. `file` is for the messages.
  [[nodiscard]] static Checked<ZipArchive> open(std::string bytes, const std::string& file);

  /// Names as stored, in the order of the archive.
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  /// The entry of that name at the archive's root: letter by letter, else whatever its case, else without extension
  /// where `extension` ("." included) is given. Never one in a folder.
  [[nodiscard]] const std::string* find(std::string_view name, std::string_view extension = {}) const;
  /// The content of an entry, at most `most_bytes`, and at most 1000 times what it takes in the archive. Reading stops
  /// there, whatever size the archive states.
  [[nodiscard]] Checked<std::string> read(const std::string& name, std::size_t most_bytes) const;

 private:
  struct Handle;
  std::shared_ptr<Handle> handle_;
  std::vector<std::string> names_;
  std::string file_;
};

}  // namespace luxrig
