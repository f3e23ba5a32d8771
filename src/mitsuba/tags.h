// The elements of the scene language and the attributes that each may have.
#pragma once

#include "mitsuba/node.h"

namespace burnish::mitsuba {

/// Throws InputError where the language has no such element.
void check_tag(const Node& node);

/// Throws InputError where an attribute is unknown, or one that the element requires is missing.
void check_attributes(const Node& node);

}  // namespace burnish::mitsuba
