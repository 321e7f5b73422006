#include "core/precompiled.h"
