"""Headings that tables of lines have in the trade, by the column they mean."""

from __future__ import annotations

import pytest

from tautwire.tables.columns import fields_of
from tautwire.tables.headings import read_heading

HEADINGS = {
    ("supports", "mast"): """
        Mast | Mast no. | Structure | Structure ID | OLE structure | Pole number | Mast-Nr.
        | Mastnr | Mast-Bezeichnung | Stützpunkt-Nr. | Standort | N° de poteau | N° support
        | Poteau n° | Poste nº | Perfil | Nº de perfil | Apoyo nº | Sostegno n. | N.
        sostegno | Numero palo | Palo | Mastenummer | Stolpe nr | Stolpnummer | 支柱编号 | 杆号
    """,
    ("supports", "chainage"): """
        Chainage | Chainage (m) | Km | Station | Kilometer | Kilometrierung | Bahn-km | PK |
        P.K. | Point kilométrique | Punto kilométrico | Pk (km) | Progressiva chilometrica |
        Chilometro | km-posisjon | Km-tal | 里程 | 公里标 | Milepost [ft] | Ch. | Stationing
    """,
    ("supports", "span_length"): """
        Span | Span length [m] | Span (ft) | Spannweite | Mastabstand | Längsspannweite [m]
        | Feldlänge | Portée | Longueur de portée | Vano | Vano (m) | Longitud del vano |
        Campata | Lunghezza campata | Luce [m] | Spennlengde | Spennvidde | Spannlängd | 跨距
    """,
    ("supports", "contact_height"): """
        Contact wire height | CW height [mm] | Wire height | Fahrdrahthöhe | FD-Höhe | Höhe
        des Fahrdrahts | Hauteur du fil de contact | Hauteur FC | Altura del hilo de
        contacto | Altura HC | Altezza filo di contatto | Altezza del filo | Quota filo |
        Kontakttrådhøyde | Trådhøyde | Kontakttrådshöjd | 导高 | 接触线高度
    """,
    ("supports", "encumbrance"): """
        System height | Encumbrance | Systemhöhe | Encombrement | Hauteur de système |
        Altura de sistema | Altura de catenaria | Encumbramiento | Ingombro | Altezza del
        sistema | Systemhøyde | Systemhöjd | 结构高度
    """,
    ("supports", "contact_stagger"): """
        Stagger | Stagger (mm) | CW stagger | Offset | Seitenlage | Zickzack |
        Seitenverschiebung FD | Désaxement | Désaxement FC | Descentramiento |
        Descentramiento HC | Poligonazione | Disassamento | Sikksakk | Sicksack | 拉出值
    """,
    ("droppers", "span"): """
        Span | Span no. | Feld | Feld-Nr. | Portée | N° portée | Vano | Vano nº | Campata |
        Campata n. | Spenn | Spann | 跨号
    """,
    ("droppers", "dropper"): """
        Dropper | Dropper no. | Hanger | Hänger | Hänger-Nr. | Pendule | Pendule n° |
        Péndola | Péndola nº | Pendino | Pendino n. | Hengetråd nr | Bärtråd | 吊弦编号 | 吊弦号
    """,
    ("droppers", "position"): """
        Position [m] | Distance from support | Distance from mast | Lage [m] | Abstand vom
        Mast | Abstand v. Stützpunkt | Abscisse | Position du pendule | Distance au support
        | Distancia al apoyo | Posición | Distanza dal sostegno | Posizione [m] | Ascissa |
        Avstand fra mast | Läge | 距定位点距离 | 位置
    """,
    ("droppers", "length"): """
        Length | Dropper length | Hanger length [mm] | Länge | Hängerlänge | Longueur |
        Longueur pendule | Longitud | Longitud péndola | Lunghezza | Lunghezza pendino |
        Lengde | Hengetrådlengde | Längd | 吊弦长度 | 长度
    """,
    ("droppers", "presag"): """
        Pre-sag | Presag [mm] | Sag | Vordurchhang | Durchhang | Flèche | Flèche initiale |
        Contre-flèche | Flecha | Flecha inicial | Freccia | Prefreccia | Pilhøyde |
        Nedhängning | 预弛度 | 弛度
    """,
    ("wires", "wire"): """
        Wire | Conductor | Leiter | Seil | Draht | Fil | Câble | Conducteur | Hilo | Cable |
        Conductor | Filo | Conduttore | Fune | Ledning | Leder | Ledare | Lina | 线索 | 导线
    """,
    ("wires", "use"): """
        Type | Conductor type | Material | Typ | Bauart | Bezeichnung | Désignation | Type
        de fil | Tipo | Tipo de conductor | Materiale | Tipo conduttore | 型号
    """,
    ("wires", "tension"): """
        Tension | Tension [kN] | Mechanical tension | Tensile force | Zugkraft |
        Nachspannkraft | Tension mécanique | Effort de traction | Tense | Tensión mecánica |
        Tiro | Tiro [daN] | Tensione | Strekk | Strekkraft | Spänning | Inspänningskraft |
        张力 | Pull (lbf)
    """,
    ("wires", "mass"): """
        Mass | Mass per metre | Linear mass [kg/m] | Unit mass | Metergewicht | Masse
        linéique | Masse [kg/m] | Masa lineal | Peso lineal [kg/m] | Massa lineica | Peso
        [kg/m] | 单位质量 | Weight (lb/ft)
    """,
}
"""Headings in English, German, French, Spanish, Italian, Norwegian, Swedish and Chinese, by the
kind of table and the column. From memory of the trade, not from the lists that are tested."""


@pytest.mark.parametrize(("kind", "column"), HEADINGS)
def test_headings_of_the_trade(kind: str, column: str) -> None:
    """Every heading means its column and no other."""
    headings = " ".join(HEADINGS[kind, column].split()).split(" | ")
    readings = {text: read_heading(text, "", fields_of(kind)) for text in headings}
    assert {t: r.field.name if r else None for t, r in readings.items()} == dict.fromkeys(
        headings, column
    )


def test_weights_need_their_unit() -> None:
    """A weight may be a mass or a force per length: only with a unit of mass it is the mass."""
    fields = fields_of("wires")
    assert [read_heading(text, "", fields) for text in ("Weight", "Peso", "Peso [N/m]")] == [
        None
    ] * 3
    found = read_heading("Weight (lb/ft)", "", fields)
    assert found is not None
    assert (found.field.name, found.unit) == ("mass", "lb/ft")


def test_abbreviations_are_no_groups() -> None:
    """What stands before the point of an abbreviation belongs to the heading, a device does not."""
    assert read_heading("Abst. v. Mast", "", fields_of("droppers")) is None
    found = read_heading("PI.F_1_1 [N]", "", fields_of("recording"))
    assert found is not None
    assert (found.field.name, found.strip, found.sensor) == ("sensor_force", 1, 1)
