/* The headers whose functions Python calls. */
#include "laconic/laconic.h"

#include "laconic/articulated.h"
#include "laconic/batch.h"
#include "laconic/derivatives.h"
#include "laconic/estimate.h"
#include "laconic/filter.h"
