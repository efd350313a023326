"""Small files as loggers write them: two channels at 1 kHz, or what is wrong with them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

RATE = 1000.0
COUNT = 240
T = np.arange(COUNT) / RATE
LO = np.round(2.0 * np.sin(55.4 * T) + 0.01, 5)
BASE = np.round(1.5 * np.cos(55.4 * T), 5)
COUNTED = (np.rint(1e5 * LO), np.rint(1e5 * BASE))


@dataclass(frozen=True)
class Case:
    """A file: its bytes, and what is to be found in it or why it is refused."""

    data: bytes
    names: tuple[str, ...] = ("lo", "base")
    units: tuple[str | None, ...] = ("V", "V")
    rate: float | None = RATE
    scale: float = 1.0
    refused: str = ""
    name: str = "rec.csv"
    said: str = ""
    dialect: str = ""


def rows(form: str, start: float = 0.0, columns=(LO, BASE), times=T, tick: float = 1.0) -> str:
    """Return a line a sample; {t}, {a}, {b}, {k} are time, first and second channel, and number."""
    return "".join(
        form.format(t=start + time / tick, a=columns[0][k], b=columns[1][k], k=k) + "\n"
        for k, time in enumerate(times.tolist())
    )


def comma(text: str) -> str:
    """Return a text with decimal commas."""
    return text.replace(".", ",")


def stamps(form: str, hour: int = 9, minute: int = 0, second: int = 0) -> str:
    """Return a line a sample; {h}, {m}, {s}, {ms} are those of the time of the day."""
    told = []
    for k in range(COUNT):
        ms = (hour * 3600 + minute * 60 + second) * 1000 + k
        whole = ms // 1000 % 86400
        clock = {"h": whole // 3600, "m": whole // 60 % 60, "s": whole % 60, "ms": ms % 1000}
        told.append(form.format(**clock, a=LO[k], b=BASE[k], k=k, day=2 + ms // 86400000))
    return "\n".join(told) + "\n"


def lvm(x_columns: str, separator: str = "Tab", decimal: str = ".", segments: int = 1) -> str:
    """Return a LabVIEW measurement file."""
    head = (
        f"LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\t{separator}\n"
        f"Decimal_Separator\t{decimal}\nMulti_Headings\t{'Yes' if segments > 1 else 'No'}\nX_Columns\t{x_columns}\n"
        "Time_Pref\tAbsolute\nOperator\tlab\nDate\t2026/03/02\nTime\t09:00:00.25\n***End_of_Header***\t\n\t\n"
    )
    size = COUNT // segments
    body = ""
    for part in range(segments):
        begin = part * size
        body += (
            f"Channels\t2\t\t\nSamples\t{size}\t{size}\t\nDate\t2026/03/02\t2026/03/02\t\nTime\t09:00:00.25\t09:00:00.25\t\n"
            f"Y_Unit_Label\tVolts\tVolts\t\nX_Dimension\tTime\tTime\t\nX0\t{begin / RATE:.6E}\t{begin / RATE:.6E}\t\n"
            "Delta_X\t1.000000E-3\t1.000000E-3\t\n***End_of_Header***\t\t\t\n"
        )
        form = {"One": "{t:.6f}\t{a}\t{b}", "No": "\t{a}\t{b}", "Multi": "{t:.6f}\t{a}\t{t:.6f}\t{b}"}[x_columns]
        names = "X_Value\tlo\tX_Value\tbase\tComment\n" if x_columns == "Multi" else "X_Value\tlo\tbase\tComment\n"
        cut = slice(begin, begin + size)
        body += names + rows(form, times=T[cut], columns=(LO[cut], BASE[cut])) + "\n"
    text = head + body
    if decimal == ",":
        top, _, rest = text.partition("***End_of_Header***")
        text = top + "***End_of_Header***" + rest.replace(".", ",")
    if separator == "Comma":
        text = text.replace("\t", ",")
    return text


GRAPHTEC = (
    "Vendor,GRAPHTEC Corporation\nModel,GL980\nVersion,Ver1.02\nSampling interval,1ms\nTotal data points,240\n"
    "Start time,2026-03-02,09:00:00\nEnd time,2026-03-02,09:00:00\nTrigger Time,2026-03-02,09:00:00\nAMP settings\n"
    'CH,Signal name,Input,Range,Filter,Span\nCH1,"lo",DC,10V,Off,+10.0000,-10.0000,V\nCH2,"base",DC,10V,Off,+10.0000,'
    "-10.0000,V\nLogic/Pulse,Off\nData\nNumber,Date&Time,ms,CH1,CH2,Alarm1-10,AlarmOut\nNO.,Time,ms,V,V,A1234567890,A1234\n"
)
YOKOGAWA = (
    '"Header Size",15\n"Model Name","DL850"\n"Comment",""\n"BlockNumber",1\n"TraceName","lo","base"\n'
    '"BlockSize",240,240\n"Date","2026/03/02","2026/03/02"\n"Time","09:00:00.25","09:00:00.25"\n"VUnit","V","V"\n'
    '"SampleRate",1000,1000\n"HResolution",1.0E-03,1.0E-03\n"HOffset",0,0\n"HUnit","s","s"\n'
    '"DisplayBlockSize",240,240\n"DisplayPointNo.",1,1\n'
)
TEKTRONIX = (
    "Model,MSO24\nFirmware Version,1.38.14\n\nWaveform Type,ANALOG\nPoint Format,Y\nHorizontal Units,s\n"
    "Horizontal Scale,0.04\nHorizontal Delay,0.0\nSample Interval,1e-03\nRecord Length,240\nGating,0.0% to 100.0%\n"
    "Probe Attenuation,1\nVertical Units,V\nVertical Offset,0\nVertical Scale,1\nVertical Position,0\n,\n,\n,\nLabel,\n"
)
TDS = ["Record Length,2.4e+02,", "Sample Interval,1.0e-03,", "Trigger Point,1.2e+02,", "Source,CH1,"]
SIEMENS = "Title1\tRun 1\nTitle2\tNONE\nDate\t02-Mar-2026 09:00:00\n\nTime\tPoint lo:+X\tPoint base:+X\ns\tm/s^2\tg\n"

PLAIN = "{t:.5f},{a},{b}"
SEMI = "{t:.5f};{a};{b}"
HEAD = "Time [s],lo [V],base [V]\n"

LOGGERS: dict[str, Case] = {
    "keysight_infiniivision": Case(
        f"x-axis,1,2\nsecond,Volt,Volt\n{rows('{t:+.6E},{a:+.6E},{b:+.6E}', -0.1)}".encode(), ("1", "2"), ("Volt",) * 2
    ),
    "keysight_benchlink_utf16": Case(
        (
            "Name:,run\nOwner:,lab\nComments:,\nInstrument:,34970A\n\nScan,Time,101 <lo> (VDC),102 <base> (VDC)\n"
            + stamps("{k},02/03/2026 {h:02}:{m:02}:{s:02}:{ms:03},{a},{b}")
        ).encode("utf-16"),
        ("101 <lo>", "102 <base>"),
        ("VDC", "VDC"),
    ),
    "keysight_34470": Case(
        ("Reading,lo (V DC),base (V DC),Elapsed (ms)\n" + rows("{k},{a},{b},{t:.1f}", tick=1e-3)).encode(),
        units=("V DC", "V DC"),
    ),
    "tektronix_mso": Case((TEKTRONIX + "TIME,CH1\n" + rows("{t:.6e},{a}", -0.1)).encode(), ("CH1",), (None,)),
    "tektronix_tds": Case(
        "".join(f"{TDS[k] if k < len(TDS) else ',,'},{T[k] - 0.1:.6f},{LO[k]}\n" for k in range(COUNT)).encode(),
        refused="line 4 is no row like those below it",
    ),
    "tektronix_tds_stated": Case(
        "".join(
            f"{TDS[k] if k < len(TDS) else ',,'},{T[k] - 0.1:.6f},{LO[k]}\n" for k in range(COUNT)
        ).encode(),
        ("5",),
        (None,),
        dialect="data=1 head=0 time=4 time_unit=s",
    ),
    "lecroy": Case(
        (
            "LECROYWS104,12345,Waveform\nSegments,1,SegmentSize,240\nSegment,TrigTime,TimeSinceSegment1\n"
            "#1,02-Mar-2026 09:00:00,0\nTime,Ampl\n" + rows("{t:.7f},{a}", -0.1)
        ).encode(),
        ("Ampl",),
        (None,),
        None,
        said="without a unit",
    ),
    "rigol": Case(
        (
            "X,CH1,CH2,Start,Increment,\nSequence,Volt,Volt,-1.2e-01,1.0e-03\n" + rows("{k},{a:.2e},{b:.2e},,")
        ).encode(),
        ("CH1", "CH2"),
        ("Volt", "Volt"),
        None,
        said="without a unit",
    ),
    "siglent": Case(
        (
            "Record Length,Analog:240\nSample Interval,Analog:0.001\nVertical Units,CH1:V,CH2:V\n"
            "Source,CH1,CH2\nSecond,Volt,Volt\n" + rows("{t:.6f},{a},{b}", -0.1)
        ).encode(),
        ("CH1", "CH2"),
        ("Volt", "Volt"),
    ),
    "picoscope_ms_mv": Case(
        ("Time,Channel A,Channel B\n(ms),(mV),(V)\n\n" + rows("{t:.8f},{a},{b}", -100, tick=1e-3)).encode(),
        ("Channel A", "Channel B"),
        ("mV", "V"),
    ),
    "picoscope_german": Case(
        ("Zeit;Kanal A;Kanal B\n(ms);(V);(V)\n\n" + comma(rows("{t:.8f};{a};{b}", -100, tick=1e-3))).encode(),
        ("Kanal A", "Kanal B"),
    ),
    "picoscope_over_range": Case(
        ("Time,A,B\n(s),(V),(V)\n\n" + rows(PLAIN) + "0.24,∞,0.1\n0.241,-∞,0.1\n").encode(),
        ("A", "B"),
        said="lost",
    ),
    "lvm_one": Case(lvm("One").encode(), units=("Volts", "Volts"), name="rec.lvm"),
    "lvm_no": Case(lvm("No").encode(), units=("Volts", "Volts"), name="rec.lvm"),
    "lvm_multi": Case(lvm("Multi").encode(), units=("Volts", "Volts"), name="rec.lvm"),
    "lvm_decimal_comma": Case(lvm("One", decimal=",").encode(), units=("Volts", "Volts"), name="rec.lvm"),
    "lvm_comma": Case(lvm("One", separator="Comma").encode(), units=("Volts", "Volts"), name="rec.txt"),
    "lvm_segments": Case(lvm("One", segments=3).encode(), units=("Volts", "Volts"), name="rec.lvm"),
    "labview_waveforms": Case(
        (
            "waveform\tlo\tbase\nt0\t02/03/2026 09:00:00.000\t02/03/2026 09:00:00.000\ndelta t\t0.001\t0.001\n\n"
            "time\tY[0]\tY[1]\n" + stamps("02/03/2026 {h:02}:{m:02}:{s:02}.{ms:03}\t{a}\t{b}")
        ).encode(),
        ("Y", "Y (2)"),
        ("0", "1"),
        said="without a unit",
    ),
    "catman": Case(
        (
            "catman export\n\nTime  1 - default sample rate\tlo\tbase\ns\tV\tV\n" + rows("{t:.5f}\t{a}\t{b}")
        ).encode("cp1252")
    ),
    "catman_german": Case(
        ("Zeit  1 - Standardmessrate [s]\tlo [V]\tbase [V]\n" + comma(rows("{t:.5f}\t{a}\t{b}"))).encode("cp1252")
    ),
    "dewesoft": Case(
        (
            "Data file:run01.dxd\nStart time:02/03/2026 09:00:00.250\nSample rate:1000 Hz\n\n"
            "Time (s)\tlo (V)\tbase (V)\n"
            + rows("{t:.5f}\t{a}\t{b}")
        ).encode(),
        name="rec.txt",
    ),
    "dewesoft_absolute": Case(
        (
            "Time (-);lo (V);base (V)\n"
            + comma(stamps("02/03/2026 {h:02}:{m:02}:{s:02}.{ms:03}000;{a};{b}", 23, 59, 59))
        ).encode("utf-8-sig"),
    ),
    "imc_famos": Case(
        ('"Zeit [s]";"lo [V]";"base [V]"\r\n' + comma(rows(SEMI)).replace("\n", "\r\n")).encode("cp1252")
    ),
    "siemens_testlab": Case(
        (SIEMENS + rows("{t:.6E}\t{a}\t{b}")).encode(), ("Point lo:+X", "Point base:+X"), ("m/s^2", "g"), name="r.txt"
    ),
    "yokogawa": Case((YOKOGAWA + rows(",{a:.5E},{b:.5E}")).encode(), said="SampleRate"),
    "graphtec": Case(
        (GRAPHTEC + stamps("{k},2026/03/02 {h:02}:{m:02}:{s:02},{ms:03},{a:+.5f},{b:+.5f},LLLLLLLLLL,LLLL")).encode(),
        ("CH1", "CH2"),
    ),
    "hioki": Case(
        (
            "\"HIOKI MR8847\"\n\"Comment\",\"\"\n\"Trigger Time\",\"'26-03-02 09:00:00.000\"\n"
            '"Time[s]","CH1-1[V]","CH1-2[V]"\n' + rows('"{t:+.9E}","{a:+.5E}","{b:+.5E}"')
        ).encode("shift_jis"),
        ("CH1-1", "CH1-2"),
    ),
    "picolog": Case(
        (
            ',"lo (V)","base (V)"\n' + stamps('"2026-03-02T{h:02}:{m:02}:{s:02}.{ms:03}+00:00",{a},{b}')
        ).encode("utf-8-sig"),
    ),
    "windaq": Case(
        ("Relative Time (s), lo (Volt), base (Volt)\n" + rows("{t:10.5f}, {a:9.5f}, {b:9.5f}")).encode(),
        units=("Volt", "Volt"),
    ),
    "labjack": Case(
        ("Time\tv0\tv1\n" + rows("{t:.6f}\t{a:.6f}\t{b:.6f}")).encode(), ("v0", "v1"), (None, None), None,
        said="without a unit", name="data_0.dat",
    ),
    "arduino_millis": Case(
        ("millis,lo,base\n" + rows("{t:.0f},{a},{b}", 1042, tick=1e-3)).encode(), units=(None, None), name="serial.log"
    ),
    "arduino_headless": Case(rows(PLAIN).encode(), ("1", "2", "3"), (None,) * 3, None, said="called by their numbers"),
    "arduino_two_integers": Case(
        rows("{k},{a}", columns=(np.round(LO * 100 + 512).astype(int), BASE)).encode(), refused="may part two columns"
    ),
    "arduino_two_integers_stated": Case(
        rows("{k},{a}", columns=(np.round(LO * 100 + 512).astype(int), BASE)).encode(),
        ("1", "2"), (None, None), None, dialect="separator=comma decimal=point",
    ),
    "arduino_labels": Case(rows("t:{k},lo:{a},base:{b}").encode(), refused="no rows of numbers"),
    "arduino_arrow": Case(stamps("{h:02}:{m:02}:{s:02}.{ms:03} -> {a}").encode(), ("3",), (None,)),
    "numpy_savetxt": Case(
        ("# t [s] lo [V] base [V]\n" + rows("{t:.18e} {a:.18e} {b:.18e}")).encode(), name="rec.txt"
    ),
    "octave": Case(
        ("% Time [s], lo [V], base [V]\n" + rows("   {t:.8e},   {a:.8e},   {b:.8e}")).encode(), name="rec.asc"
    ),
    "fortran_columns": Case(
        ("  Time [s]      lo [V]    base [V]\n" + rows("{t:10.5f}  {a:10.5f}  {b:10.5f}")).encode(), name="rec.prn"
    ),
    "pandas_index": Case((",Time [s],lo [V],base [V]\n" + rows("{k},{t:.5f},{a},{b}")).encode()),
    "r_row_names": Case(("Time [s],lo [V]\n" + rows("{k},{t:.5f},{a}")).encode(), refused="2 names, but rows have 3"),
    "head_too_long": Case(("Time [s],lo [V],base [V],x [V]\n" + rows(PLAIN)).encode(), refused="4 names.*3 fields"),
    "scale_row_of_counts": Case(
        ("Time,lo,base\ns,V,V\nScale,0.00001,0.00001\n" + rows("{t:.3f},{a:.0f},{b:.0f}", columns=COUNTED)).encode(),
        units=("count", "count"),
        said="line 3 states the scale 1e-05 V of 'lo': it is not applied",
    ),
    "scale_row_beside_fractions": Case(
        ("Time [s];lo [V];base [V]\n" + comma("Factor;2.5;1.0\n" + rows(SEMI))).encode(),
        units=(None, "V"), said="line 2 states the scale 2.5 V of 'lo': it is not applied",
    ),
    "units_in_cells": Case(("Time,lo,base\n" + rows("{t:.3f} s,{a} V,{b}V")).encode()),
    "units_in_cells_german": Case(("Zeit;lo;base\n" + comma(rows("{t:.3f} s;{a} V;{b} V"))).encode("cp1252")),
    "units_in_cells_of_two_sizes": Case(
        ("Time,lo,base\n" + rows("{t:.3f} s,{a} V,{b} V").replace("0.002 s,", "2 ms,")).encode()
    ),
    "units_in_cells_beside_others_in_the_head": Case(
        ("Time [s],lo [m],base\n" + rows("{t:.3f},{a} V,{b} V")).encode(), refused="cells are in V, the head says m"
    ),
    "units_in_cells_of_two_kinds": Case(
        ("Time,lo,base\n" + rows("{t:.3f} s,{a} V,{b} V").replace(f"{LO[9]} V", f"{LO[9]} mm")).encode(),
        refused="column 'lo': cells are in mm, others are in V",
    ),
    "excel_sep": Case(("sep=;\nTime [s];lo [V];base [V]\n" + comma(rows(SEMI))).encode("utf-8-sig")),
    "excel_unicode_text": Case(
        ("Zeit [s]\tlo [V]\tbase [V]\r\n" + comma(rows("{t:.5f}\t{a}\t{b}")).replace("\n", "\r\n")).encode("utf-16")
    ),
    "utf16_without_mark": Case((HEAD + rows(PLAIN)).encode("utf-16-be")),
    "windows_micro": Case(
        ("Zeit [µs];lo [µm];base [m/s²]\n" + rows("{t:.0f};{a};{b}", tick=1e-6)).encode("cp1252"), units=("µm", "m/s²")
    ),
    "quoted_decimal_comma": Case(
        (HEAD + "".join(f'"{line}"\n'.replace(";", '","') for line in comma(rows(SEMI)).splitlines())).encode()
    ),
    "classic_mac": Case((HEAD + rows(PLAIN)).replace("\n", "\r").encode()),
    "doubled_returns": Case((HEAD + rows(PLAIN)).replace("\n", "\r\r\n").encode()),
    "trailing_comma": Case((HEAD + rows(PLAIN + ",")).encode(), said="the last field is empty in all"),
    "trailing_comma_in_both": Case(("Time [s],lo [V],base [V],\n" + rows(PLAIN + ",")).encode()),
    "trailing_comma_and_rate": Case(
        ("# sampling_rate: 1000\nlo [V],base [V]\n" + rows("{a},{b},")).encode(), said="the last field is empty in all"
    ),
    "units_in_a_row": Case(("t;lo;base\ns;V;V\n" + comma(rows(SEMI))).encode()),
    "units_by_slash": Case(("t/s,lo / V,base / V\n" + rows(PLAIN)).encode()),
    "units_by_comma": Case(('"Time, s","lo, V","base, V"\n' + rows(PLAIN)).encode()),
    "units_by_in": Case(("Zeit in s;lo in V;base in V\n" + comma(rows(SEMI))).encode()),
    "dates_and_times": Case(
        (
            "Datum;Uhrzeit;lo [V];base [V]\n" + comma(stamps("0{day}.03.2026;{h:02}:{m:02}:{s:02}.{ms:03};{a};{b}"))
            .replace("02,03,2026", "02.03.2026")
        ).encode("cp1252")
    ),
    "american_clock": Case(
        ("Time,lo [V],base [V]\n" + stamps("3/{day}/2026 11:59:59.{ms:03} AM,{a},{b}")).encode(),
    ),
    "elapsed_clock": Case(("Elapsed,lo [V],base [V]\n" + stamps("{m:02}:{s:02}.{ms:03},{a},{b}")).encode()),
    "unix_epoch": Case(
        ("timestamp,lo [V],base [V]\n" + rows("{t:.6f},{a},{b}", 1772442000)).encode(), rate=None, said="without a unit"
    ),
    "time_in_minutes": Case(("time_ms,lo [V],base [V]\n" + rows("{t:.3f},{a},{b}", tick=1e-3)).encode()),
    "rate_without_unit": Case(
        ("Sample rate: 1\n\nlo [V],base [V]\n" + rows("{a},{b}")).encode(), rate=None, said="unit of frequency"
    ),
    "rate_in_khz": Case(("Sample rate: 1 kHz\n\nlo [V],base [V]\n" + rows("{a},{b}")).encode()),
    "interval_in_ms": Case(("Sampling interval [ms];1,0\nlo [V];base [V]\n" + comma(rows("{a};{b}"))).encode()),
    "counts": Case(
        ("Time [s],lo [LSB],base [counts]\n" + rows("{t:.5f},{a},{b}")).encode(), units=("LSB", "counts")
    ),
    "two_of_a_name": Case(("Time [s],lo [V],lo [V]\n" + rows(PLAIN)).encode(), ("lo", "lo (2)")),
    "comments_between": Case(
        (HEAD + rows(PLAIN, times=T[:100]) + "# shaker on\n" + rows(PLAIN)[len(rows(PLAIN, times=T[:100])) :]).encode(),
        said="1 comment",
    ),
    "word_for_a_lost_sample": Case((HEAD + rows(PLAIN) + "0.24,OVER,0.1\n").encode(), said="lost"),
    "cut_off": Case((HEAD + rows(PLAIN) + "0.24,0.1").encode(), said="cut off"),
    "cut_off_within_a_number": Case(
        (HEAD + rows("{t:.5f},{a:.5f},{b:.5f}") + "0.24000,0.10000,0.1").encode(), said="cut off"
    ),
    "no_last_line_end": Case((HEAD + rows("{t:.5f},{a:.5f},{b:.5f}")).rstrip("\n").encode()),
    "thousands": Case(
        ("Time [s];lo [V]\n" + "".join(f"{k};1.234,{k:03}\n" for k in range(50))).encode(),
        refused="no rows of numbers; its end",
    ),
    "ragged": Case((HEAD + rows(PLAIN) + "0.24,0.1\n" + "0.241,0.1,0.2\n" * 30).encode(), refused="line 242 "),
    "ragged_at_once": Case((HEAD + "0.0,0.01\n" + rows(PLAIN)).encode(), refused="line 2 is no row"),
    "ragged_soon": Case((HEAD + "0.0,0.01,1.5\n0.001,0.1\n" + rows(PLAIN)).encode(), refused="line 3 is no row"),
    "damaged_decimal_comma": Case(
        (comma(rows("{a};{b}", times=T[:99])) + "-1,,280;0\n" + comma(rows("{a};{b}"))).encode(), refused="line 100 is"
    ),
    "decimal_commas_parted_by_commas": Case(
        comma("".join(f"{a + 3:.4f},{b + 3:.4f},\n" for a, b in zip(LO, BASE, strict=True)))
        .encode(), refused="may part two columns or be a decimal sign",
    ),
    "head_again": Case((HEAD + rows(PLAIN) + HEAD + rows(PLAIN)).encode(), refused="line 242 is no row"),
    "only_a_head": Case(HEAD.encode(), refused="no rows"),
    "binary": Case(bytes(range(256)) * 20, refused="zero bytes"),
    "japanese": Case(("時間 [s],lo [V],base [V]\n" + rows(PLAIN)).encode("shift_jis"), dialect="encoding=shift_jis"),
    "missing_in_a_number_of_rows": Case(
        (
            HEAD.replace("Time [s]", "No.") + rows("{k},{a},{b}", times=T[:-40])
            + rows("{k}9,{a},{b}", times=T[-40:], columns=(LO[-40:], BASE[-40:]))
        ).encode(),
        rate=None, said="rows are missing",
    ),
}  # fmt: skip
