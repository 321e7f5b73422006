#pragma once
/// Reads a photometric file, with a tilt file from its own folder.

#include <filesystem>

#include "core/photometry/files/eulumdat.h"
#include "core/photometry/files/file_text.h"
#include "core/photometry/files/ies.h"
#include "core/photometry/files/photometric_file.h"

namespace luxrig {

inline Checked<IesFile> load_ies(const std::filesystem::path& path) {
  const Checked<std::string> text = file_text::read_text(path, "IES LM-63");
  if (!text) return tl::unexpected(text.error());
  return parse_ies(*text, path.string(), tilt_files_beside(path));
}

inline Checked<EulumdatFile> load_eulumdat(const std::filesystem::path& path) {
  const Checked<std::string> text = file_text::read_text(path, "EULUMDAT");
  if (!text) return tl::unexpected(text.error());
  return parse_eulumdat(*text, path.string());
}

inline Checked<PhotometricFile> load_photometric_file(const std::filesystem::path& path) {
  const Checked<std::string> text = file_text::read_text(path, "IES LM-63 or EULUMDAT");
  if (!text) return tl::unexpected(text.error());
  return parse_photometric_text(*text, path.string(), tilt_files_beside(path));
}

}  // namespace luxrig
