#pragma once
/// What `--version` tells. A program that reads it links luxrig_version.

namespace luxrig {

/// "0.1.0 (8022d83)", "0.1.0 (8022d83-dirty)" where files differ from that commit, "0.1.0" where there is no git.
extern const char* const kVersion;

}  // namespace luxrig
