/* The headers whose functions Python calls, without what checks a program's definitions (build.h). */
#define LACONIC_IN_CORE
#include "laconic/laconic.h"

#include "laconic/articulated.h"
#include "laconic/articulated_friction.h"
#include "laconic/batch.h"
#include "laconic/derivatives.h"
#include "laconic/estimate.h"
#include "laconic/filter.h"
