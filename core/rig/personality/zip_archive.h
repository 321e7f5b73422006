#pragma once
/// A zip archive in memory, as used by GDTF and MVR files. Treated as untrusted. libzip unpacks it.

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

namespace luxrig {

inline constexpr std::size_t kMaxZipBytes = std::size_t{256} << 20;
inline constexpr std::size_t kMaxZipEntries = 10'000;

class ZipArchive {
 public:
  /// Refuses a file that is not a zip archive or exceeds the limits above. `file` is for messages.
  [[nodiscard]] static Checked<ZipArchive> open(std::string bytes, const std::string& file);

  /// Names as stored, in the order of the archive.
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  /// The entry of that name in the archive's root: the exact name, else ignoring case, else without its extension if
  /// `extension` ("." included) is given. Never an entry in a folder.
  [[nodiscard]] const std::string* find(std::string_view name, std::string_view extension = {}) const;
  /// The content of an entry. At most `max_bytes`, and at most 1000 times its compressed size. Reading stops at that
  /// limit, whatever size the archive states.
  [[nodiscard]] Checked<std::string> read(const std::string& name, std::size_t max_bytes) const;

 private:
  struct Handle;
  std::shared_ptr<Handle> handle_;
  std::vector<std::string> names_;
  std::string file_;
};

}  // namespace luxrig
