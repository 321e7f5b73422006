#pragma once
/// The text of `--version`. A program that reads it links luxrig_version.

namespace luxrig {

/// "0.1.0 (8022d83)"; "0.1.0 (8022d83-dirty)" if files differ from that commit; "0.1.0" without git.
extern const char* const kVersion;

}  // namespace luxrig
