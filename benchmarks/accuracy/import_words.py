"""Titles, units, rates and forms of time that programs of many countries write; what drawn files are made of."""

from __future__ import annotations

NAMES = {
    "english": (("Time", "Elapsed Time", "Test time"), ("Displacement", "Extension", "Position"), ("Load", "Force")),
    "german": (("Zeit", "Prüfzeit"), ("Weg", "Standardweg", "Traversenweg"), ("Kraft", "Prüfkraft")),
    "french": (("Temps", "Durée"), ("Déplacement", "Course"), ("Force", "Charge")),
    "spanish": (("Tiempo",), ("Desplazamiento", "Posición", "Recorrido"), ("Fuerza", "Carga")),
    "italian": (("Tempo",), ("Spostamento", "Posizione", "Corsa"), ("Forza", "Carico")),
    "portuguese": (("Tempo",), ("Deslocamento", "Posição"), ("Força", "Carga")),
    "polish": (("Czas", "Godzina"), ("Przemieszczenie", "Droga"), ("Siła", "Obciążenie")),
    "czech": (("Čas",), ("Posunutí", "Dráha", "Poloha"), ("Síla", "Zatížení")),
    "dutch": (("Tijd",), ("Verplaatsing", "Positie"), ("Kracht", "Belasting")),
    "swedish": (("Tid",), ("Förskjutning", "Läge"), ("Kraft", "Last")),
    "russian": (("Время",), ("Перемещение", "Положение"), ("Сила", "Нагрузка", "Усилие")),
    "chinese": (("时间", "试验时间"), ("位移", "变形"), ("力", "载荷", "试验力", "负荷")),
    "japanese": (("時間", "経過時間"), ("変位", "ストローク"), ("荷重", "試験力")),
    "korean": (("시간",), ("변위", "위치"), ("하중", "힘")),
}
STRESS = {
    "english": ("Compressive stress", "Compressive strain"),
    "german": ("Spannung", "Dehnung"),
    "french": ("Contrainte", "Déformation relative"),
    "spanish": ("Esfuerzo", "Deformación unitaria"),
    "italian": ("Tensione", "Deformazione percentuale"),
    "portuguese": ("Tensão", "Deformação específica"),
    "polish": ("Naprężenie", "Odkształcenie 1"),
    "czech": ("Napětí", "Poměrná deformace"),
    "dutch": ("Spanning", "Rek"),
    "swedish": ("Spänning", "Töjning"),
    "russian": ("Напряжение", "Относит. деформация"),
    "chinese": ("压缩应力", "应变"),
    "japanese": ("応力", "ひずみ"),
    "korean": ("응력", "변형률"),
}
CODE_PAGES = {
    "english": ("utf-8",),
    "german": ("cp1252", "utf-8-sig", "utf-16"),
    "french": ("cp1252", "utf-8"),
    "spanish": ("cp1252", "utf-8"),
    "italian": ("cp1252", "utf-8"),
    "portuguese": ("cp1252", "utf-8"),
    "polish": ("cp1250", "utf-8"),
    "czech": ("cp1250", "utf-8-sig"),
    "dutch": ("utf-8",),
    "swedish": ("cp1252",),
    "russian": ("cp1251", "utf-8"),
    "chinese": ("gb18030", "utf-8", "utf-16"),
    "japanese": ("cp932", "utf-8-sig"),
    "korean": ("cp949", "utf-8"),
}
COMMA = {"german", "french", "spanish", "italian", "portuguese", "polish", "czech", "dutch", "swedish", "russian"}
"""Languages whose machines write a decimal comma."""
PREAMBLES = {
    "english": ("Test method;Compression", "Operator;Smith", "Rate;10.00;mm/s"),
    "german": ("Prüfer;Müller", "Vorkraft;0,1;N"),
    "french": ("Essai;Compression", "Vitesse;10;mm/s"),
    "polish": ('Test : Tempo 1;"600,00000";mm/min', 'Etykieta próbki;"P03"'),
    "spanish": ("Ensayo;Compresión", "Velocidad;10;mm/s"),
    "japanese": ("試験日;2025/11/19", "試験速度;10;mm/s"),
    "chinese": ("试样编号;12", "试验速度;10;mm/s"),
}
RATES = (
    "Sample rate;{rate};Hz",
    "Acquisition rate :;{rate:.1f};[Hz]",
    "Sampling frequency (Hz);{rate}",
    "Sampling interval;{step};s",
)

LENGTHS = {"mm": (1.0, 4), "um": (1e3, 1), "cm": (0.1, 5), "m": (1e-3, 7), "in": (1 / 25.4, 6)}
FORCES = {
    "N": (1.0, 4),
    "mN": (1e3, 1),
    "kN": (1e-3, 7),
    "gf": (1 / 9.80665e-3, 2),
    "kgf": (1 / 9.80665, 5),
    "lbf": (1 / 4.4482216, 5),
}
TIMES = {"s": (1.0, 4), "ms": (1e3, 1), "min": (1 / 60, 7)}
TIME_FORMS = (
    "plain",
    "plain",
    "plain",
    "clock",
    "iso",
    "compact",
    "date_clock",
    "clock_ms",
    "secs_nsecs",
    "epoch",
    "two_bases",
    "counter",
    "rate",
    "coarse",
    "packets",
)
"""How time is written; ``plain`` is one column of numbers."""
