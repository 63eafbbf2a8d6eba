# SPDX-License-Identifier: Apache-2.0
"""Planted faults in a netlist (tools/costs/netlist.py)."""
import pathlib
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.dont_write_bytecode = True
sys.path.insert(0, str(ROOT / "tools" / "costs"))
# pylint: disable=wrong-import-position
from contract import Bad  # noqa: E402
import netlist  # noqa: E402

TEXT = r"""
module bench (a, q);
  LUT4 #(
    .INIT(16'h8000)
  ) \card.sum[0]_LUT4_Z  (
    .A(a),
    .Z(\card.sum[0] )
  );
  TRELLIS_FF #(
    .REGSET("RESET")
  ) kept (
    .DI(\card.sum[0] ),
    .Q(q[3])
  );
  TRELLIS_DPR16X4 table (
    .DO({ wide, \other  }),
    .DI(q)
  );
  DP16KD block (
    .DOA0(q[1])
  );
endmodule
"""


class Faults(unittest.TestCase):
    def test_every_kind_of_net_and_cell(self):
        text, told = netlist.with_faults(TEXT, 4)
        self.assertEqual(told, [r"1 LUT4.Z \card.sum[0]_LUT4_Z", "2 TRELLIS_FF.Q kept", "3 TRELLIS_DPR16X4.DO table",
                                "4 DP16KD.DOB0 block: not connected, so there is no fault"])
        self.assertIn("    .Z(fault_1_sound )\n  );\n  wire fault_1_sound;\n  fault #(.NUMBER(1)) fault_1 (.sound(fault_1_sound), .net(\\card.sum[0] ));\n", text)
        self.assertIn("    .Q(fault_2_sound )\n", text)
        self.assertIn(".net(q[3]));", text)
        self.assertIn("    .DO({ fault_3_sound , \\other  }),\n", text)
        self.assertEqual(text.count("fault #("), 3)

    def test_none(self):
        self.assertEqual(netlist.with_faults(TEXT, 0), (TEXT, []))

    def test_other_text_is_refused(self):
        with self.assertRaisesRegex(Bad, "has no cells of the FPGA"):
            netlist.with_faults("module bench (a);\nendmodule\n", 1)

    def test_other_folder_is_refused(self):
        with tempfile.TemporaryDirectory() as folder, self.assertRaisesRegex(Bad, "has no netlist.v; expected a folder of tools/synthesis one card --keep"):
            netlist.build(folder, f"{folder}/model.so", 0, print)


if __name__ == "__main__":
    unittest.main()
