// SPDX-License-Identifier: Apache-2.0
/* What every table of functions of a bitstream begins with. A library exports one function, which
   returns its table; who loads it reads no further unless both numbers are those it was built
   with. */
#ifndef CDE_ABI_HEAD_H
#define CDE_ABI_HEAD_H
#include <stdint.h>

typedef struct cde_abi_head {
  uint32_t version; /* CDE_*_ABI */
  uint32_t size;    /* bytes of the table */
} cde_abi_head;

#endif
