#pragma once
/// Files that only our user may read: tokens, accounts, keys.

#include <cstddef>
#include <filesystem>
#include <string>

#include "core/result.h"

namespace luxrig {

/// Writes it with mode 600. It is whole at any time, and on disk when this returns.
[[nodiscard]] Result<void> write_secret(const std::filesystem::path& file, const std::string& text);

/// Reads it. Refused, with the way to mend it, if it is no plain file, is longer, belongs to another user than ours or
/// root, or if others may do what these bits of its mode say.
[[nodiscard]] Checked<std::string> read_secret(const std::filesystem::path& file, std::size_t most_bytes,
                                               unsigned others_may_not = 077);

}  // namespace luxrig
