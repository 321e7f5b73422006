#pragma once
/// Schemas of the parts of a status: what status_json.h, question_json.h and room_view.h write.

#include "tools/luxrigd/api/schema.h"

namespace luxrig {

/// By name: Status, StatusChanges, Rig and others, for the components of the OpenAPI file.
[[nodiscard]] schema::Schema status_schemas();

}  // namespace luxrig
