#pragma once
/// Whole files, read and written.

#include <filesystem>
#include <string>

#include "core/result.h"

namespace luxrig {

/// Writes text to a file. A reader, or the next start after a power cut, sees the old content or the new, never half. A
/// fault if it cannot be written, or if the new content is there but a power cut may bring the old one back.
[[nodiscard]] Result<void> write_file(const std::filesystem::path& path, const std::string& text);
/// Entries made, renamed or removed in the folder survive a power cut from now on; else false, and errno says why.
[[nodiscard]] bool sync_folder(const std::filesystem::path& folder);
/// Reads a file of at most 64 MiB.
[[nodiscard]] Checked<std::string> read_file(const std::filesystem::path& path);

}  // namespace luxrig
